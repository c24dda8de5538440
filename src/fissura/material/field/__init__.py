"""Random field of strength and fracture energy: covariance, expansion, marginal distribution, realisation."""

from fissura.material.field.covariance import MODELS, Covariance, covariance_named
from fissura.material.field.expansion import Expansion, expand
from fissura.material.field.field import RandomField, field_from_case
from fissura.material.field.grid import Accuracy
from fissura.material.field.marginal import MARGINALS, Marginal, marginal_named

__all__ = [
    "MARGINALS",
    "MODELS",
    "Accuracy",
    "Covariance",
    "Expansion",
    "Marginal",
    "RandomField",
    "covariance_named",
    "expand",
    "field_from_case",
    "marginal_named",
]
