"""The `biped` command, one file per verb."""
