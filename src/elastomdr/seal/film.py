"""A lubricated line contact: film and pressure between a parabola and a soft surface.

Lengths along the film over a, films over a^2/R, pressures over p_ref = 2 W'/(pi a), so
that the load is pi/2. Both surfaces move along +x, with the mean velocity u:

    H = H_0 + X^2/2 + int K(X - S) P(S) dS                      rubber
    d/dX (phi H^3 dP_f/dX) = lam dH/dX,  P_f > 0                Reynolds
    P_f = 0,  d(lam H)/dX >= 0                                  where the film has ruptured
    P = P_f + P_a(H),   int P dX = pi/2                         fluid and asperities; load

with lam = 12 eta u R^2/(a^3 p_ref) and the flow factor phi (1 on smooth surfaces). The
ruptured film carries the flow that reaches it, so that the flow is the same everywhere:
with one rise of pressure and a film that only widens behind it, this is the condition
that conserves mass (Jakobsson & Floberg; Giacopini et al., J. Tribol. 132 (2010)
041702). Where the film would close again, the point counts as not solved.

P is linear between nodes that crowd at both edges of the dry contact. Flows are those of
a finite volume at each node, so that they agree to rounding. Rupture, a, b >= 0 and
a b = 0, is written as min(a, b) = 0, and all is solved by Newton's method with the exact
Jacobian: from a good guess the rupture finds its node in a few steps. From a poor one the
function of Fischer and Burmeister is safer, a + b - sqrt(a^2 + b^2) = 0.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from ..checks import Array

LOAD = 0.5 * np.pi
_STEPS = 50  # of Newton's method
_CLOSE = 1e-10  # residual of the equations at which it may end
_ENOUGH = 1e-7  # residual of a solved contact
_SAME = 1e-7  # that the pressure of a solved film may be off, over the largest
_EVEN = 1e-10  # relative difference of flow along a solved film
_LEAST_STEP = 1e-4  # share of a Newton step below which the search gives up
_FLOODED = 19.0  # half-widths ahead of the contact at which a film begins
_OUTLET = 0.15  # zone of dense nodes at the outlet over that at the inlet
# of the way from the edge to the least film, where the outlet's nodes are
_NARROWS = 0.4
_NEAR = 0.01  # half-widths of this that are worth it
_START = 0.3  # lam at which a search begins, from Hertz' pressure
_RATIO = 1.8  # of lam between one solution and the next, at most
_THICK = 1.0  # lam above which the pressure alone is foretold
_HALVED = 6  # times a step of lam may be halved
_KEPT = 0.1  # of the least film, that one step must leave

Asperities = Callable[[Array], tuple[Array, Array]]  # film to P_a and its slope
Factor = Callable[[Array], tuple[Array, Array]]  # film to phi and its slope


class FilmContact(NamedTuple):
    """What carries and what flows, all over the scales of the contact."""

    parameter: float  # lam
    response: Array  # (node, inner node): film per pressure of an inner node
    places: Array  # X of the nodes
    asperities: Asperities | None = None
    factor: Factor | None = None
    outlet: float | None = None  # X where the nodes of the outlet crowd


class Case(NamedTuple):
    """A contact whose parameter can be varied on the way to it."""

    parameter: float  # lam
    edges: tuple[float, float]  # X of the dry contact, inlet and outlet
    respond: Callable[[Array], Array]  # response to the pressure on given nodes
    roughness: float = 0.0  # rms height over a^2/R
    asperities: Asperities | None = None
    factor: Factor | None = None
    inlet: float | None = None  # X where the lubricant begins; None: flooded

    def with_parameter(
        self, parameter: float, count: int, outlet: float | None = None
    ) -> FilmContact:
        """The contact with another parameter, on `count` nodes that crowd at the inlet
        and, if not at its usual place, at the outlet.
        """
        thick = max(parameter, (2 * self.roughness) ** (5 / 3))  # H about lam^0.6 / 2
        wide = 0.72 * thick**0.5  # sqrt(2H) of a rigid cylinder
        far = 200 * 0.72 * parameter**0.5  # loses 6e-5 of a rigid cylinder's load
        soft = min(0.35, 0.6 * thick**0.4)
        zones = (soft + 0.3 * wide, _OUTLET * soft + 0.1 * wide)
        # the inlet costs 1.3 lam^0.8/X^3 of the flow, and digits where it is far away
        flooded = max(_FLOODED * min(1.0, (100 * parameter) ** 0.25), 25 * zones[0])
        ends = (self.edges[0] - max(flooded, far), self.edges[1] + 1 + 3 * wide)
        if self.inlet is not None:
            ends = (self.inlet, ends[1])
        # a rigid film ruptures at 0.475 sqrt(2H)
        usual = self.edges[1] + 0.3 * 0.72 * parameter**0.5
        end = usual if outlet is None else outlet
        x = nodes((self.edges[0], end), ends, zones, count)
        response = self.respond(x)
        return FilmContact(parameter, response, x, self.asperities, self.factor, end)


class Film(NamedTuple):
    """A solved contact."""

    places: Array  # X
    film: Array  # H
    pressure: Array  # P_f of the fluid
    asperity_pressure: Array  # P_a
    approach: float  # H_0
    flow: float  # flux over lam, the film that leaves: H_m
    imbalance: float  # largest difference of flow between any two places, over the flow
    converged: bool
    outlet: float | None  # X where the nodes of the outlet crowd

    @property
    def total(self) -> Array:
        """P of all nodes, fluid and asperities."""
        return self.pressure + self.asperity_pressure


def nodes(
    edges: tuple[float, float],
    ends: tuple[float, float],
    zones: tuple[float, float],
    count: int,
) -> Array:
    """Places from end to end, uniform in sum_e asinh((x - x_e)/zone_e) of both edges x_e.

    The spacing grows with the distance from the nearer edge; `count` 2n - 1 contains the
    nodes of `count` n.
    """
    both = list(zip(edges, zones, strict=True))
    length = ends[1] - ends[0]
    fine = [np.array(ends)]
    for edge, zone in both:
        near = zone * np.sinh(np.linspace(0, np.arcsinh(length / zone), 4 * count))
        fine += [edge - near, edge + near]
    places = np.unique(np.concatenate(fine))
    places = places[(places >= ends[0]) & (places <= ends[1])]
    way: Any = sum(np.arcsinh((places - edge) / zone) for edge, zone in both)
    wanted = np.linspace(way[0], way[-1], count)
    x = np.interp(wanted, way, places)
    for _ in range(3):
        missed = sum(np.arcsinh((x - edge) / zone) for edge, zone in both) - wanted
        x = x - missed / sum(1 / np.hypot(x - edge, zone) for edge, zone in both)
    x[0], x[-1] = ends
    return x


def solve(contact: FilmContact, pressure: Array, approach: float) -> Film:
    """The film from a guess at the pressures of the inner nodes and at H_0."""
    guess = np.append(pressure, approach)
    film = _newton(contact, guess, _least)
    return film if film.converged else _newton(contact, guess, _fischer_burmeister)


Rupture = Callable[[Array, Array], tuple[Array, Array, Array]]


def _least(fluid: Array, gathered: Array) -> tuple[Array, Array, Array]:
    """min(a, b) and its slopes by a and b."""
    dry = (fluid < gathered).astype(float)
    return np.minimum(fluid, gathered), dry, 1 - dry


def _fischer_burmeister(fluid: Array, gathered: Array) -> tuple[Array, Array, Array]:
    """a + b - sqrt(a^2 + b^2) and its slopes by a and b."""
    length = np.hypot(fluid, gathered)
    missed = fluid + gathered - length
    length[length == 0] = np.inf
    return missed, 1 - fluid / length, 1 - gathered / length


def _newton(contact: FilmContact, unknown: Array, rupture: Rupture) -> Film:
    """The film from a guess, rupture written by a function of a and b."""
    x, count = contact.places, contact.places.size
    width = 0.5 * (x[2:] - x[:-2])
    response = np.column_stack([contact.response, np.ones(count)])
    here, norm = _balance(contact, unknown), np.inf
    for _ in range(_STEPS):
        scale = here.conductance[1:] + here.conductance[:-1]
        missed, *slopes = _missed(here, unknown, width, scale, rupture)
        norm = float(np.linalg.norm(missed))
        if not _CLOSE < norm < np.inf:
            break
        jacobian = _jacobian(contact, here, response, width, slopes)
        try:
            step = np.linalg.solve(jacobian, -missed)
        except np.linalg.LinAlgError:
            break
        share = 1.0
        while share > _LEAST_STEP:
            moved = unknown + share * step
            trial = _balance(contact, moved)
            if trial.film.min() > _KEPT * here.film.min():
                left, *_ = _missed(trial, moved, width, scale, rupture)
                after = np.linalg.norm(left)
                if after < (1 - 0.1 * share) * norm or after < _CLOSE:
                    break
            share *= 0.5
        else:
            break
        unknown, here = moved, trial
    return _packed(contact, unknown, here, norm)


class _Balance(NamedTuple):
    """What follows from the unknowns."""

    film: Array  # H of the nodes
    fluid: Array  # P_f of the nodes
    asperity: Array  # P_a of the nodes
    stiffness: Array  # dP_a/dH of the nodes
    conductance: Array  # phi H^3 over the spacing, of the faces between nodes
    slope: Array  # of the conductance, by the film at the face
    flux: Array  # lam H - phi H^3 P_f', of the faces


def _balance(contact: FilmContact, unknown: Array) -> _Balance:
    x = contact.places
    film = unknown[-1] + 0.5 * x**2 + contact.response @ unknown[:-1]
    asperity, stiffness = np.zeros(x.size), np.zeros(x.size)
    if contact.asperities is not None:
        inner = contact.asperities(film[1:-1])
        asperity[1:-1], stiffness[1:-1] = inner
    fluid = np.zeros(x.size)
    fluid[1:-1] = unknown[:-1] - asperity[1:-1]
    face = 0.5 * (film[1:] + film[:-1])
    cube, slope = face**3, 3 * face**2
    if contact.factor is not None:
        factor, change = contact.factor(face)
        cube, slope = cube * factor, slope * factor + cube * change
    spacing = np.diff(x)
    cube, slope = cube / spacing, slope / spacing
    flux = contact.parameter * face - cube * np.diff(fluid)
    return _Balance(film, fluid, asperity, stiffness, cube, slope, flux)


def _missed(
    here: _Balance, unknown: Array, width: Array, scale: Array, rupture: Rupture
) -> tuple[Array, Array, Array]:
    """Residuals, rupture at each inner node and the load; and the slopes of the former
    by the pressure and by the flux that leaves the node, the scale held.
    """
    gathered = np.diff(here.flux) / scale
    missed, of_fluid, of_gathered = rupture(here.fluid[1:-1], gathered)
    total = np.append(missed, width @ unknown[:-1] - LOAD)
    return total, of_fluid, of_gathered / scale


def _jacobian(
    contact: FilmContact,
    here: _Balance,
    response: Array,
    width: Array,
    slopes: list[Array],
) -> Array:
    """Slopes of the residuals by the unknowns."""
    of_fluid, of_flux = slopes
    # by the fluid's pressure, tridiagonal
    below, above = here.conductance[:-1], here.conductance[1:]
    diagonal = of_fluid + of_flux * (below + above)
    # by the film: H of a face is the mean of two nodes; P_f = P - P_a(H)
    steep = 0.5 * (contact.parameter - here.slope * np.diff(here.fluid))
    left, right = -steep[:-1], steep[1:]
    stiff = here.stiffness
    by_film = (
        of_flux * (left + below * stiff[:-2]),
        of_flux * (left + right) - diagonal * stiff[1:-1],
        of_flux * (right + above * stiff[2:]),
    )
    whole = np.empty((diagonal.size + 1, response.shape[1]))
    whole[-1] = np.append(width, 0.0)  # the load
    matrix, product = whole[:-1], np.empty((diagonal.size, response.shape[1]))
    np.multiply(by_film[0][:, None], response[:-2], out=matrix)
    for factor, rows in zip(by_film[1:], (response[1:-1], response[2:]), strict=True):
        matrix += np.multiply(factor[:, None], rows, out=product)
    row = np.arange(diagonal.size)
    matrix[row, row] += diagonal
    matrix[row[1:], row[:-1]] -= (of_flux * below)[1:]
    matrix[row[:-1], row[1:]] -= (of_flux * above)[:-1]
    return whole


def _even(contact: FilmContact, here: _Balance) -> tuple[Array, float, float]:
    """The fluid's pressure under which exactly the same flux passes everywhere before
    the rupture, the film as it is; that flux; and how far it is from even after all,
    relative.

    Newton's method leaves rounding of a large film far ahead, and of steep asperities,
    in the flux. Here it is left in the pressure, where it is harmless.
    """
    last = _rupture(here) + 1
    face = 0.5 * (here.film[1:] + here.film[:-1])[:last]
    conductance, entrained = here.conductance[:last], contact.parameter * face
    flow = float((entrained / conductance).sum() / (1 / conductance).sum())
    fluid = np.zeros(here.fluid.size)
    fluid[1 : last + 1] = np.cumsum((entrained - flow) / conductance)
    fluid[last] = 0.0
    flux = entrained - conductance * np.diff(fluid)[:last]
    return fluid, flow, float(np.ptp(flux) / abs(flow)) if flow != 0 else np.inf


def _rupture(here: _Balance) -> int:
    """Number of the last node before the rupture."""
    scale = here.conductance[1:] + here.conductance[:-1]
    full = here.fluid[1:-1] > np.abs(np.diff(here.flux)) / scale
    return int(np.flatnonzero(full)[-1]) + 1 if full.any() else 0


def _packed(
    contact: FilmContact, unknown: Array, here: _Balance, missed: float
) -> Film:
    """The film, and how well it keeps its flow.

    Behind the rupture the film is in part void: there it carries what reaches it, as
    long as it only widens.
    """
    fluid, flow, imbalance = _even(contact, here)
    moved = np.abs(fluid - here.fluid).max() / unknown[:-1].max()
    behind = here.flux[_rupture(here) + 1 :]
    widens = bool((behind >= flow * (1 - 1e-9)).all())
    good = missed < _ENOUGH and moved < _SAME and imbalance < _EVEN and widens
    return Film(
        contact.places,
        here.film,
        np.maximum(fluid, 0.0),
        here.asperity,
        float(unknown[-1]),
        flow / contact.parameter,
        imbalance,
        good and bool(here.film.min() > 0),
        contact.outlet,
    )


class _Known(NamedTuple):
    """What is kept of a solution: by the numbers of the nodes, whose places follow it."""

    parameter: float
    film: Array
    pressure: Array  # of the inner nodes
    approach: float  # H_0


def follow(
    cases: list[Case],
    count: int,
    levels: int = 2,
    enough: Callable[[int, list[Film]], bool] | None = None,
) -> list[list[Film]]:
    """Each case on `count` nodes and on ones twice as dense, at most `levels` in all, or
    two where these are `enough`; fewer where no film was found.

    The search goes from the case that is nearest to an easy one up and down in lam.
    """
    order = np.argsort([case.parameter for case in cases])
    ascending = np.array([cases[i].parameter for i in order])
    middle = int(np.searchsorted(ascending, _easy(cases[order[0]])))
    solved: list[list[Film]] = [[] for _ in cases]
    for way in (order[middle:], order[:middle][::-1]):
        known: list[_Known] = []
        for i in way:
            film = _walk(cases[i], known, count)
            if film is None:  # the last one was too different
                known = []
                film = _walk(cases[i], known, count)
            if film is not None:
                film = _narrowed(cases[i], film)
            while film is not None:
                solved[i].append(film)
                many = len(solved[i])
                if many == levels or (many > 1 and enough and enough(i, solved[i])):
                    break
                film = _refined(cases[i], film)
    return solved


def _easy(case: Case) -> float:
    """lam from which a search begins: the film is thick against the roughness."""
    return max(_START, (10 * case.roughness) ** (5 / 3))


def _walk(case: Case, known: list[_Known], count: int) -> Film | None:
    """From what is known to the case, in steps of lam that are halved where they fail."""
    if not known:
        first = _first(case, count)
        if first is None:
            return None
        known.append(first)
    ratio, left = _RATIO, _HALVED
    while True:
        last = known[-1].parameter
        way = case.parameter / last
        parameter = last * float(np.clip(way, 1 / ratio, ratio))
        contact = case.with_parameter(parameter, count)
        film = solve(contact, *_foretold(case, contact, known))
        if film.converged:
            known.append(_kept(parameter, film))
            del known[:-2]
            if parameter == last * way:
                return film
        elif left == 0:
            return None
        else:
            ratio, left = ratio**0.5, left - 1


def _kept(parameter: float, film: Film) -> _Known:
    return _Known(parameter, film.film, film.total[1:-1], film.approach)


def _first(case: Case, count: int) -> _Known | None:
    """From Hertz' pressure between the edges."""
    parameter = _easy(case)
    contact = case.with_parameter(parameter, count)
    x = contact.places[1:-1]
    middle, half = 0.5 * sum(case.edges), 0.5 * (case.edges[1] - case.edges[0])
    hertz = np.sqrt(np.maximum(1 - ((x - middle) / half) ** 2, 0.0))
    width = 0.5 * (contact.places[2:] - contact.places[:-2])
    hertz *= LOAD / (width @ hertz)
    dry = 0.5 * contact.places**2 + contact.response @ hertz
    approach = 0.5 * min(parameter**0.6, parameter) - dry.min()
    film = _newton(contact, np.append(hertz, approach), _fischer_burmeister)
    return _kept(parameter, film) if film.converged else None


def _foretold(
    case: Case, contact: FilmContact, known: list[_Known]
) -> tuple[Array, float]:
    """Guess from the last solutions, in log lam."""
    new, old = known[-1], known[0]
    way = np.log(contact.parameter / new.parameter)
    apart = np.log(new.parameter / old.parameter)
    share = way / apart if apart else 0.0
    pressure = new.pressure + share * (new.pressure - old.pressure)
    if contact.parameter > _THICK:
        return pressure, new.approach + share * (new.approach - old.approach)
    film = new.film * (new.film / old.film) ** share
    if share == 0.0:
        film = film * np.exp(0.6 * way)
    return _from_film(case, contact, film, np.maximum(pressure, 0.0))


def _from_film(
    case: Case, contact: FilmContact, film: Array, pressure: Array
) -> tuple[Array, float]:
    """Pressures that give the film between the edges, as they are outside: a thin film
    says more of the pressure than the pressure of the film.
    """
    x = contact.places[1:-1]
    inside = (x > case.edges[0]) & (x < case.edges[1])
    width = 0.5 * (contact.places[2:] - contact.places[:-2])
    rows, count = contact.response[1:-1][inside], int(inside.sum())
    matrix = np.ones((count + 1, count + 1))
    matrix[:-1, :-1] = rows[:, inside]
    matrix[-1] = np.append(width[inside], 0.0)
    outside = np.where(inside, 0.0, pressure)
    right = np.append(
        film[1:-1][inside] - 0.5 * x[inside] ** 2 - rows @ outside,
        LOAD - width @ outside,
    )
    try:
        solved = np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:  # a film as thick as the contact is wide
        return pressure, 0.0
    outside[inside] = solved[:-1]
    return outside, float(solved[-1])


def _narrowed(case: Case, film: Film) -> Film:
    """The film on nodes that crowd nearer to where it narrows: on a rough surface, far
    ahead of the edge.
    """
    edge, least = case.edges[1], float(film.places[film.film.argmin()])
    outlet = edge - _NARROWS * (edge - least)
    if case.asperities is None or film.outlet is None or outlet > edge - _NEAR:
        return film
    contact = case.with_parameter(case.parameter, film.places.size, outlet)
    total = CubicSpline(film.places, film.total)(contact.places[1:-1])
    thickness = np.exp(CubicSpline(film.places, np.log(film.film))(contact.places))
    guess = _from_film(case, contact, thickness, np.maximum(total, 0.0))
    again = solve(contact, *guess)
    return again if again.converged else film


def coarsened(case: Case, fine: Film) -> Film | None:
    """On every other node."""
    count = (fine.places.size + 1) // 2
    contact = case.with_parameter(case.parameter, count, fine.outlet)
    guess = _from_film(case, contact, fine.film[::2], fine.total[2:-2:2])
    coarse = solve(contact, *guess)
    return coarse if coarse.converged else None


def _refined(case: Case, coarse: Film) -> Film | None:
    """On twice as many nodes, from the film and the pressure between them."""
    count = coarse.places.size
    number, between = np.arange(count), 0.5 * np.arange(2 * count - 1)
    contact = case.with_parameter(case.parameter, 2 * count - 1, coarse.outlet)
    total = np.maximum(CubicSpline(number, coarse.total)(between), 0.0)[1:-1]
    film = np.exp(CubicSpline(number, np.log(coarse.film))(between))
    fine = solve(contact, *_from_film(case, contact, film, total))
    return fine if fine.converged else None
