"""Exact ordering by linear programmes that grow by cuts and columns."""
