"""The laws of a contact that is loaded along its surface as well."""

from __future__ import annotations

from typing import Any

from ..element.law import Foundation, as_foundation, half_space
from ..errors import InputError
from ..material.prony import Prony


def both_laws(material: Any, tangential: Any) -> tuple[Foundation, Foundation]:
    """E* of a material or `Foundation`, and G* of it or of what is given. Raises
    `InputError`.
    """
    normal = as_foundation(material)
    if tangential is None:
        if not isinstance(material, Prony):
            raise InputError(
                "tangential must be given with a Foundation, which only knows the "
                "normal direction: em.half_space(material, tangential=True), or an "
                "em.Foundation of G*."
            )
        return normal, half_space(material, tangential=True)
    if isinstance(tangential, Prony):
        return normal, half_space(tangential, tangential=True)
    if not isinstance(tangential, Foundation):
        raise InputError(
            f"tangential must be an em.Foundation of G*, got {tangential!r}."
        )
    return normal, tangential
