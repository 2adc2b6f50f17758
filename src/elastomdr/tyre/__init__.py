"""Rolling with creepage: traction and slip curves."""
