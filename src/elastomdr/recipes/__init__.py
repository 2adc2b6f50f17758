"""Answers that are a few calls of the verbs, or one closed formula: conveyors, warming, cords, damping of drives."""
