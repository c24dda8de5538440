"""Platens as further bodies: rigid, with contacts to the surface facets of the bodies under them.

A contact reaches from the nucleus of a body to the surface: in uniform strain it is strained as the material is, so
that a platen on a whole face passes the patch test.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.equilibrium import limits
from fissura.errors import InputError
from fissura.specimen import Platen
from fissura.tessellation import Contacts, Tessellation, footprint


@dataclass(frozen=True)
class WithPlatens:
    """A discretization with its platens.

    Attributes
    ----------
    tessellation : Tessellation
        The n bodies of the specimen, then the p platens; the m contacts of the specimen, then those of the platens.
    contacts : (p,) tuple of (k,) arrays
        Contacts of every platen.
    bodies : (p,) tuple of (k,) arrays
        Bodies under every platen.
    share : (m + k, 3) array or None
        Shares of their moduli that contacts have; None where all have them whole.
    """

    tessellation: Tessellation
    contacts: tuple[IntArray, ...] = ()
    bodies: tuple[IntArray, ...] = ()
    share: FloatArray | None = None


def with_platens(tessellation: Tessellation, platens: Sequence[Platen]) -> WithPlatens:
    """Put platens on the bodies of a discretization.

    Raises
    ------
    InputError
        There is nothing under a platen.
    """
    if not platens:
        return WithPlatens(tessellation)
    surface, inner, n = tessellation.surface, tessellation.contacts, len(tessellation)
    found = [footprint(surface, platen.parts) for platen in platens]
    for platen, print_ in zip(platens, found, strict=True):
        if not len(print_.facet):
            raise InputError(platen.key, "there is nothing of the specimen under it", "a place on its surface")
    facet = np.concatenate([print_.facet for print_ in found])
    area = np.concatenate([print_.area for print_ in found])
    centroid = np.concatenate([print_.centroid for print_ in found])
    owner = np.repeat(np.arange(len(platens)), [len(print_.facet) for print_ in found])
    body, normal = surface.body[facet], surface.normal[facet]
    height = np.einsum("ka,ka->k", centroid - tessellation.x[body], normal)
    contacts = Contacts(
        bodies=np.concatenate([inner.bodies, np.stack([body, n + owner], axis=1)]),
        area=np.concatenate([inner.area, area]),
        centroid=np.concatenate([inner.centroid, centroid]),
        normal=np.concatenate([inner.normal, normal]),
        length=np.concatenate([inner.length, np.maximum(height, limits.SHORTEST * np.sqrt(area))]),
        fine=np.concatenate([inner.fine, tessellation.fine[body]]),
        polygons=inner.polygons,
    )
    middles = np.array([platen.middle for platen in platens])
    whole = replace(
        tessellation,
        nucleus=np.concatenate([tessellation.nucleus, -1 - np.arange(len(platens))]),
        x=np.concatenate([tessellation.x, middles]),
        fine=np.concatenate([tessellation.fine, np.zeros(len(platens), np.bool_)]),
        volume=np.concatenate([tessellation.volume, np.ones(len(platens))]),
        contacts=contacts,
        cells=None,
    )
    slippery = np.array([platen.contact == "frictionless" for platen in platens])[owner]
    share = np.ones((len(contacts), 3))
    trace = limits.TRACE * contacts.length[len(inner) :] / np.sqrt(area)  # however near a nucleus is to the surface
    share[len(inner) :, 1:] = np.where(slippery, trace, 1.0)[:, None]
    numbers = [len(inner) + np.flatnonzero(owner == k) for k in range(len(platens))]
    return WithPlatens(whole, tuple(numbers), tuple(np.unique(body[owner == k]) for k in range(len(platens))), share)
