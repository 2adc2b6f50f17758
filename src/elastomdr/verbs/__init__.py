"""The front doors: verbs that serve several rooms."""
