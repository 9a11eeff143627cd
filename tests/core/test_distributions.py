import math

import pytest
from scipy import special

from surveyapp.core.statistics import distributions as d

DOFS = [0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 17.0, 42.5, 300.0, 1e5]


@pytest.mark.parametrize("dof", DOFS)
@pytest.mark.parametrize("p", [1e-6, 0.01, 0.3, 0.5, 0.9, 0.975, 0.999])
def test_student_quantile_equals_scipy(p: float, dof: float) -> None:
    assert d.student_quantile(p, dof) == pytest.approx(special.stdtrit(dof, p), rel=1e-8, abs=1e-9)


@pytest.mark.parametrize("dof", DOFS)
@pytest.mark.parametrize("p", [0.001, 0.01, 0.5, 0.95, 0.99])
def test_chi_square_quantile_equals_scipy(p: float, dof: float) -> None:
    expected = special.chdtri(dof, 1 - p)
    assert d.chi_square_quantile(p, dof) == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("value", [0.2, 1.0, 3.84, 20.0])
@pytest.mark.parametrize(("n", "m"), [(1, 1), (2, 17), (9, 3.5), (40, 200)])
def test_f_tail_equals_scipy(value: float, n: float, m: float) -> None:
    expected = special.fdtrc(n, m, value)
    assert d.f_tail(value, dof_numerator=n, dof_denominator=m) == pytest.approx(expected, rel=1e-9)


def test_infinite_degrees_of_freedom_are_the_normal_distribution() -> None:
    assert d.student_quantile(0.975, math.inf) == pytest.approx(1.959963984540054)
    tail = d.f_tail(3.841458820694124, dof_numerator=1, dof_denominator=math.inf)
    assert tail == pytest.approx(0.05)


def test_printed_t_table() -> None:
    # W. S. Gosset's distribution, table in any textbook: t(0.975; 1, 2, 5, 10)
    for dof, printed in [(1, 12.706), (2, 4.303), (5, 2.571), (10, 2.228)]:
        assert d.student_quantile(0.975, dof) == pytest.approx(printed, abs=5e-4)


def test_impossible_probability_is_refused() -> None:
    with pytest.raises(ValueError, match="no Student quantile"):
        d.student_quantile(1.0, 3.0)
