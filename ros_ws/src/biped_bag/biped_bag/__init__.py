"""Bags: record, play, look into, verify, mend, cut and export them.

storage         bags on the disk: write, read, check
recorder        the graph into a bag
player          a bag onto the graph
recovery        a broken bag made sound, and what is lost counted
verification    a recorded learner answers again
cut, export, info    what else can be done with a bag
verbs           all of it as commands, with their exit statuses
"""
