"""Uses of the public names that a type checker must refuse: pyright, which `.ci/run` calls, reports each
`ignore` that silences nothing.
"""

# pyright: reportUnnecessaryTypeIgnoreComment=error

import elastomdr as em

rubber, ball, road = em.Prony(1e6, [], []), em.Sphere(5e-3), em.SelfAffine(0.8, 0.3, 1e2, 1e6)

# Names
em.fricton  # pyright: ignore[reportAttributeAccessIssue]  # no such name
em.fit.read_material("file")  # pyright: ignore[reportAttributeAccessIssue]  # no such name
em.load_material("epdm-70").creep(1.0)  # pyright: ignore[reportAttributeAccessIssue]  # the old name
em.friction(rubber, ball, velocity=1.0, load=1.0).muu  # pyright: ignore[reportAttributeAccessIssue]  # no such field

# Arguments
em.Prony(1e6, [5e5], [1e-3], kynd="tensile")  # pyright: ignore[reportCallIssue]  # no such argument
em.Prony(1e6, [5e5])  # pyright: ignore[reportCallIssue]  # times are missing
em.friction(rubber, ball, load=1.0)  # pyright: ignore[reportCallIssue]  # velocity is missing
em.friction(rubber, ball, velocity=1.0, lod=1.0)  # pyright: ignore[reportCallIssue]  # no such argument
em.friction([rubber, rubber], ball, velocity=1.0, lod=1.0)  # pyright: ignore[reportCallIssue]  # no such argument, in a list of materials either
em.Line(seed=4)  # pyright: ignore[reportCallIssue]  # no such option
em.Maxwell(1e6, 1e-3, nu=0.5)  # pyright: ignore[reportCallIssue]  # no such property

# Types
em.Prony(1e6, [5e5], [1e-3], kind="tensil")  # pyright: ignore[reportArgumentType]  # no such kind
em.Prony([1e6], [5e5], [1e-3])  # pyright: ignore[reportArgumentType]  # one equilibrium modulus
em.Prony(1e6, [5e5], [1e-3], shift=293.15)  # pyright: ignore[reportArgumentType]  # no shift law
em.Sphere("5 mm")  # pyright: ignore[reportArgumentType]  # a text
em.Sphere([5e-3])  # pyright: ignore[reportArgumentType]  # one radius
em.SelfAffine("0.8", 0.3, 1e2, 1e6)  # pyright: ignore[reportArgumentType]  # a text
em.friction(rubber, ball, velocity="1 m/s", load=1.0)  # pyright: ignore[reportArgumentType]  # a text
em.friction(rubber, ball, velocity=["1", "2"], load=1.0)  # pyright: ignore[reportArgumentType]  # texts
em.friction(ball, rubber, velocity=1.0, load=1.0)  # pyright: ignore[reportArgumentType]  # the wrong way round
em.friction(ball, ball, velocity=1.0, load=1.0)  # pyright: ignore[reportArgumentType]  # no material
em.friction([rubber, ball], ball, velocity=1.0, load=1.0)  # pyright: ignore[reportArgumentType]  # one of them is no material
em.friction("epdm-70", ball, velocity=1.0, load=1.0)  # pyright: ignore[reportArgumentType]  # a name, which em.load_material takes
em.friction(rubber, 5e-3, velocity=1.0, load=1.0)  # pyright: ignore[reportArgumentType]  # no shape
em.friction(rubber, ball, velocity=1.0, load=1.0, model="avaraged")  # pyright: ignore[reportArgumentType]  # no such model
em.friction(rubber, ball, velocity=1.0, load=1.0, model=em.Line)  # pyright: ignore[reportArgumentType]  # the class of a model, not one
em.friction(rubber, road, velocity=1.0, pressure=3e5, heat=0.2)  # pyright: ignore[reportArgumentType]  # no em.Heat
em.rolling(rubber, road, velocity=1.0, load=1.0)  # pyright: ignore[reportArgumentType]  # a surface does not roll
em.impact(rubber, ball, mass="10 g", velocity=1.0)  # pyright: ignore[reportArgumentType]  # a text
em.indent(rubber, road, time=[0.0, 1.0], depth=[0.0, 1e-4])  # pyright: ignore[reportArgumentType]  # no body
em.springs(ball, 1e-3)  # pyright: ignore[reportArgumentType]  # no material
em.fit.master_curve("file.csv")  # pyright: ignore[reportArgumentType]  # a path, which em.read_dma takes
em.friction(rubber, ball, velocity=1.0, load=1.0).to_excel()  # pyright: ignore[reportCallIssue]  # the path is missing

# Options
em.friction(rubber, ball, velocity=1.0, load=1.0).plot(style="papers")  # pyright: ignore[reportArgumentType]  # no such style
em.Spectrum([1.0, 2.0], [1.0, 0.5], convention="3d")  # pyright: ignore[reportArgumentType]  # no such convention
em.plan(rubber, ball, velocity=1.0, load=1.0, quantity="sliding")  # pyright: ignore[reportArgumentType]  # no such quantity
em.fit.material(em.read_dma("file.csv"), law="wlf")  # pyright: ignore[reportArgumentType]  # no such law
