"""Laws of one's own, held against the catalogue's effect and against what nobody can mean."""

import numpy as np
import pytest

import fct


def test_a_law_of_ones_own_says_what_the_catalogue_s_effect_says(fit):
    tried = fct.try_law(fit, lambda curve, c: curve["force_N"] + c * curve["time_s"], {"c": 1e-4})
    fitted = fit.add("drift").identify().params.loc["effects.drift.c"]
    # Nothing drifts here: both say so, within a fraction of the error that both give.
    assert abs(tried.values["c"] - fitted["value"]) < 0.5 * fitted["std_error"]
    # A fit also allows for the noise's memory and the mesh.
    assert 0 < tried.std_errors["c"] < fitted["std_error"]
    assert tried.chi2_after <= tried.chi2_before and tried.fall < 0.05
    assert list(tried.shift.index) == list(fit.jacobian["tearing"].columns)


def test_a_load_train_that_gives_is_found_in_a_curve_that_lacks_it(fit):
    """The record is replaced by the model's curve at a displacement less 0.02 mm/N times its force."""
    import copy

    from fct.own import _taken_off

    given = copy.deepcopy(fit)
    for curve in given.curves.values():
        force = curve["force_model_N"].to_numpy()
        curve["force_measured_N"] = _taken_off(curve, force, 0.02 * force)
        curve["residual_N"] = curve["force_measured_N"] - curve["force_model_N"]
    tried = fct.try_law(given, lambda curve, c: c * curve["force_N"], {"c": 0.1}, site="load_train")
    assert tried.values["c"] == pytest.approx(0.02, rel=1e-4)
    assert tried.fall > 0.999 and (tried.shift.abs() < 1e-2).all()


def test_taking_off_is_exact_where_the_curve_is_straight(fit):
    from fct.own import _taken_off

    u = np.concatenate([np.linspace(0, 1, 11), np.linspace(1, 0.5, 6)])
    curve = fit.curves["tearing"].head(0).reindex(range(17))
    curve["displacement_mm"], curve["segment"] = u, ["pull"] * 11 + ["back"] * 6
    force = np.where(curve["segment"] == "pull", 2 * u, 2 + 3 * (u - 1))
    slope = np.where(curve["segment"] == "pull", 2.0, 3.0)
    assert np.allclose(_taken_off(curve, force, np.full(17, 0.03)), force - 0.03 * slope)


def test_what_cannot_be_tried_says_why(fit):
    with pytest.raises(fct.InputError, match="site"):
        fct.try_law(fit, lambda curve, c: curve["force_N"], {"c": 1.0}, site="grips")
    with pytest.raises(fct.InputError, match="empty"):
        fct.try_law(fit, lambda curve: curve["force_N"], {})
    with pytest.raises(fct.InputError, match="rows of"):
        fct.try_law(fit, lambda curve, c: np.zeros(3), {"c": 1.0})
    with pytest.raises(fct.ComputeError, match="no number"):
        fct.try_law(fit, lambda curve, c: curve["force_N"] * np.nan, {"c": 1.0})
