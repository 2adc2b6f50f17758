"""A rough surface or line under a pressure: contact, friction, heat."""
