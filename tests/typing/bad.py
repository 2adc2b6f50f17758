"""Uses of the public names that a type checker must refuse: each marked line is an error."""

import elastomdr as em

rubber, ball, road = em.Prony(1e6, [], []), em.Sphere(5e-3), em.SelfAffine(0.8, 0.3, 1e2, 1e6)

# Names
em.fricton  # error: no such name
em.fit.read_material("file")  # error: no such name
em.load_material("epdm-70").creep(1.0)  # error: the old name
em.friction(rubber, ball, velocity=1.0, load=1.0).muu  # error: no such field

# Arguments
em.Prony(1e6, [5e5], [1e-3], kynd="tensile")  # error: no such argument
em.Prony(1e6, [5e5])  # error: times are missing
em.friction(rubber, ball, load=1.0)  # error: velocity is missing
em.friction(rubber, ball, velocity=1.0, lod=1.0)  # error: no such argument
em.friction([rubber, rubber], ball, velocity=1.0, lod=1.0)  # error: no such argument, in a list of materials either
em.Line(seed=4)  # error: no such option
em.Maxwell(1e6, 1e-3, nu=0.5)  # error: no such property

# Types
em.Prony(1e6, [5e5], [1e-3], kind="tensil")  # error: no such kind
em.Prony([1e6], [5e5], [1e-3])  # error: one equilibrium modulus
em.Prony(1e6, [5e5], [1e-3], shift=293.15)  # error: no shift law
em.Sphere("5 mm")  # error: a text
em.Sphere([5e-3])  # error: one radius
em.SelfAffine("0.8", 0.3, 1e2, 1e6)  # error: a text
em.friction(rubber, ball, velocity="1 m/s", load=1.0)  # error: a text
em.friction(rubber, ball, velocity=["1", "2"], load=1.0)  # error: texts
em.friction(ball, rubber, velocity=1.0, load=1.0)  # error: the wrong way round
em.friction(ball, ball, velocity=1.0, load=1.0)  # error: no material
em.friction([rubber, ball], ball, velocity=1.0, load=1.0)  # error: one of them is no material
em.friction("epdm-70", ball, velocity=1.0, load=1.0)  # error: a name, which em.load_material takes
em.friction(rubber, 5e-3, velocity=1.0, load=1.0)  # error: no shape
em.friction(rubber, ball, velocity=1.0, load=1.0, model="avaraged")  # error: no such model
em.friction(rubber, ball, velocity=1.0, load=1.0, model=em.Line)  # error: the class of a model, not one
em.friction(rubber, road, velocity=1.0, pressure=3e5, heat=0.2)  # error: no em.Heat
em.rolling(rubber, road, velocity=1.0, load=1.0)  # error: a surface does not roll
em.line_contact(rubber, road, velocity=[1.0, 2.0], pressure=3e5)  # error: one velocity
em.line_contact(rubber, road, velocity=1.0, pressure=3e5, model="persson")  # error: a line has one model
em.impact(rubber, ball, mass="10 g", velocity=1.0)  # error: a text
em.indent(rubber, road, time=[0.0, 1.0], depth=[0.0, 1e-4])  # error: no body
em.springs(ball, 1e-3)  # error: no material
em.fit.master_curve("file.csv")  # error: a path, which em.read_dma takes
em.friction(rubber, ball, velocity=1.0, load=1.0).to_excel()  # error: the path is missing

# Options
em.friction(rubber, ball, velocity=1.0, load=1.0).plot(style="papers")  # error: no such style
em.Spectrum([1.0, 2.0], [1.0, 0.5], convention="3d")  # error: no such convention
em.plan(rubber, ball, velocity=1.0, load=1.0, quantity="sliding")  # error: no such quantity
em.fit.material(em.read_dma("file.csv"), law="wlf")  # error: no such law
