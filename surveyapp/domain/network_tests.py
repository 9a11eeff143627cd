"""What the tests of an adjusted network say: global test, suspects, what was left out, removals."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from surveyapp_models.angles import RHO_ARCSEC


@dataclass(frozen=True, slots=True)
class LeftOut:
    """An observation that missed by more than the stated tolerance: a check that is not met.

    Parameters
    ----------
    place : int
    description : str
    misfit_m, tolerance_m : float
        Across the sight [m].
    """

    place: int
    description: str
    misfit_m: float
    tolerance_m: float

    def to_dict(self) -> dict[str, object]:
        """Keys of a check in the JSON."""
        return {
            "rule": "network.gross_error",
            "clause": "tolerance of the network (tol-abs)",
            "value": self.misfit_m,
            "limit": self.tolerance_m,
            "unit": "m",
            "confirmed": True,
            "pass": False,
            "where": self.description,
            "text": "left out before the adjustment",
        }


@dataclass(frozen=True, slots=True)
class Removal:
    """What the adjustment says without one observation, or without some of one cause.

    Parameters
    ----------
    place : int
    description : str
    standardized : float
        Residual over its standard deviation with the observation in.
    sum_of_squares : float
        v'Pv without it.
    ratio : float or None
        A-posteriori over a-priori sigma0 without it.
    passed : bool or None
        Global test without it.
    suspects : int
        How many observations are suspected then.
    left_out : int
        Observations that are left out together.
    """

    place: int
    description: str
    standardized: float
    sum_of_squares: float
    ratio: float | None
    passed: bool | None
    suspects: int
    left_out: int = 1

    def to_dict(self) -> dict[str, object]:
        """Keys of the JSON."""
        return {
            "observation": self.description,
            "left_out": self.left_out,
            "standardized": self.standardized,
            "sum_of_squares": self.sum_of_squares,
            "ratio": self.ratio,
            "pass": self.passed,
            "suspects": self.suspects,
        }


@dataclass(frozen=True, slots=True)
class GlobalTest:
    """Test of the a-priori sigma0, two-sided: chi-square, or F where sigmas were estimated.

    Parameters
    ----------
    sum_of_squares : float
        v'Pv with P = sigma_apriori^2 * inverse covariance.
    sigma_apriori : float
    ratio : float or None
        A-posteriori over a-priori sigma0; None without degrees of freedom.
    lower, upper : float or None
        Bounds of the ratio.
    probability : float
    passed : bool or None
    sigma_dof : float or None
        Degrees of freedom of the sigmas themselves; None where they are known beforehand.
    """

    sum_of_squares: float
    sigma_apriori: float
    ratio: float | None
    lower: float | None
    upper: float | None
    probability: float
    passed: bool | None
    sigma_dof: float | None = None

    def to_dict(self) -> dict[str, object]:
        """Keys of the JSON."""
        values = asdict(self)
        values["pass"] = values.pop("passed")
        return values


@dataclass(frozen=True, slots=True)
class Suspect:
    """An observation whose test exceeds the family's critical value."""

    place: int
    description: str
    standardized: float
    estimated_error: float
    angular: bool

    def to_dict(self) -> dict[str, object]:
        """Keys of the JSON."""
        small = RHO_ARCSEC if self.angular else 1.0
        return {
            "observation": self.description,
            "standardized": self.standardized,
            "estimated_error": self.estimated_error * small,
            "unit": "arcsec" if self.angular else "m",
        }


@dataclass(frozen=True, slots=True)
class Snooping:
    """Test of the largest standardized residual at a level for the whole family.

    Parameters
    ----------
    statistic : str
        ``normal`` (sigma0 known) or ``tau`` (sigma0 estimated).
    level : float
        Probability of accusing anything at all where nothing is wrong.
    tests : int
        Distinct tests in the family.
    critical : float or None
        Critical value; None where nothing can be tested.
    suspects : tuple of Suspect
        Largest first. Only the first is accused: the others may be its shadow.
    """

    statistic: str
    level: float
    tests: int
    critical: float | None
    suspects: tuple[Suspect, ...] = ()

    def to_dict(self) -> dict[str, object]:
        """Keys of the JSON."""
        return {
            "statistic": self.statistic,
            "level": self.level,
            "tests": self.tests,
            "critical": self.critical,
            "suspects": [item.to_dict() for item in self.suspects],
        }
