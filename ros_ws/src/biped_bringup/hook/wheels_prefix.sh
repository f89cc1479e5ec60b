# ROS from wheels has no setup file that would name its prefix, so this one does: it is
# the prefix of the Python that the executables here run with. An installed ROS 2 names
# its own.
IFS= read -r _biped_python < "$COLCON_CURRENT_PREFIX/lib/biped_bringup/biped"
_biped_prefix="$(dirname "$(dirname "${_biped_python#??}")")"
if [ -e "$_biped_prefix/share/ament_index/resource_index/packages/rclpy" ]; then
  case ":$AMENT_PREFIX_PATH:" in
    *":$_biped_prefix:"*) ;;
    *) export AMENT_PREFIX_PATH="${AMENT_PREFIX_PATH%:}:$_biped_prefix" ;;
  esac
fi
unset _biped_python _biped_prefix
