"""How a scene is computed: the plan, the steady passage, the sweep over velocities, the march in time."""
