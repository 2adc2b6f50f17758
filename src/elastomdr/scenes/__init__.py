"""The calls a user makes: each turns its arguments into a plan, runs it and packs the result."""
