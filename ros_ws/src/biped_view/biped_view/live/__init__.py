"""The live page: a robot that walks, what it measures and what it learns, in a browser.

page          the page of one viser server: scene, plots, cards, buttons
plots         ZMP error, corrections, T_err
cards         figures of the learner, legend, map of the states, as HTML
moment        what a page shows, wherever it comes from
graph_source  a running graph
record_source a recorded walk, under a time slider
memory        what a memory file tells of the learner
node          the page of a graph as a process
"""
