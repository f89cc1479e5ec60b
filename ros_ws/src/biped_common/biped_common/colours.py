"""The colours of every figure and page.

Those of M. Okabe and K. Ito, "Color Universal Design", 2008: told apart by people with
any common colour blindness. Yellow is darker than theirs, which as a line on paper is
hardly seen.
"""

INK, PAPER, GREY = "#1b1d21", "#fefefe", "#8c9096"
BLUE, VERMILLION, GREEN, PURPLE = "#0072b2", "#d55e00", "#009e73", "#cc79a7"
ORANGE, SKY, YELLOW = "#e69f00", "#56b4e9", "#c2b200"
CYCLE = (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY, YELLOW)
"""Black, the eighth, is the ink: it is kept for what others are compared with."""
