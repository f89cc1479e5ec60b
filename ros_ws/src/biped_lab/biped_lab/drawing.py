def drawn_robot(walker):
    raise NotImplementedError
