# `biped` and `ros2` come last on PATH. ROS from wheels has no setup file that would name
# its prefix, so this one does: it is the prefix of the Python that the executables here
# run with, and ros2 lies in its bin. An installed ROS 2 names its own.
_biped_bin="$COLCON_CURRENT_PREFIX/lib/biped_bringup"
IFS= read -r _biped_python < "$_biped_bin/biped"
_biped_prefix="$(dirname "$(dirname "${_biped_python#??}")")"
if [ -e "$_biped_prefix/share/ament_index/resource_index/packages/rclpy" ]; then
  _biped_bin="$_biped_bin:$_biped_prefix/bin"
  case ":$AMENT_PREFIX_PATH:" in
    *":$_biped_prefix:"*) ;;
    *) export AMENT_PREFIX_PATH="${AMENT_PREFIX_PATH%:}:$_biped_prefix" ;;
  esac
fi
case ":$PATH:" in
  *":$_biped_bin:"*) ;;
  *) export PATH="$PATH:$_biped_bin" ;;
esac
unset _biped_bin _biped_python _biped_prefix
