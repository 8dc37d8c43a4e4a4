"""What is taken for a column, what is refused, and what comes out."""

import breakaway as bk
import numpy as np
import pytest
from conftest import MODEL, drive, simulated


@pytest.fixture(scope="module")
def arrays():
    """Six seconds: an identification takes a third of the time that it takes of twenty."""
    return simulated(6.0)


def test_the_wheel_is_what_is_tested():
    assert "site-packages" in bk.__file__
    assert bk.__version__.count(".") == 2


def test_views_of_the_same_numbers_give_the_same_bits(arrays):
    """Read-only, strided, reversed, big-endian and Fortran columns, and lists."""
    wanted = bk.identify(*arrays).document
    table = np.column_stack(arrays)
    read_only = [column.copy() for column in arrays]
    for column in read_only:
        column.setflags(write=False)
    twice = [np.repeat(column, 2)[::2] for column in arrays]
    backwards = [column[::-1].copy()[::-1] for column in arrays]
    others = {
        "read-only": read_only,
        "columns of a table": [table[:, k] for k in range(3)],
        "every second": twice,
        "a negative stride": backwards,
        "big-endian": [column.astype(">f8") for column in arrays],
        "lists": [column.tolist() for column in arrays],
    }
    for what, columns in others.items():
        assert bk.identify(*columns).document == wanted, what
    assert all((one == other).all() for one, other in zip(arrays, (table[:, k] for k in range(3))))


def test_float32_and_integers_are_numbers(arrays):
    """float32 as its float64; counts as floats. Counts of 1e-3 rad are the same positions to 2⁻⁵² or so."""
    t, u, x = arrays
    single = u.astype(np.float32)
    assert bk.identify(t, single, x).document == bk.identify(t, single.astype(np.float64), x).document
    counts = np.rint(x / 1e-3).astype(np.int32)
    assert bk.identify(t, u, counts).document == bk.identify(t, u, counts.astype(float)).document
    # The equation is linear in x: b in V·s²/count is a thousandth of b in V·s²/rad.
    assert bk.identify(t, u, counts).b.value == pytest.approx(bk.identify(t, u, x).b.value * 1e-3, rel=1e-6)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda t, u, x: (t, u, x[:, None]), r"`x` has the shape \(6000, 1\)"),
        (lambda t, u, x: (t, u, 3.0), r"`x` has the shape \(\)"),
        (lambda t, u, x: (t, u[:-1], x), "`t` has 6000, `u` has 5999, `x` has 6000"),
        (lambda t, u, x: (t, u, x.astype(complex)), "`x` holds complex128"),
        (lambda t, u, x: (t, u, x > 0), "`x` holds bool"),
        (lambda t, u, x: (t, u, [str(one) for one in x]), "`x` holds <U"),
        (lambda t, u, x: (t, [[1.0], [1.0, 2.0]], x), "`u` is no array of numbers"),
        (lambda t, u, x: (t, [None] * len(t), x), "`u` holds object"),
    ],
)
def test_what_is_no_column_is_refused(change, words, arrays):
    with pytest.raises(bk.ArrayError, match=words) as error:
        bk.identify(*change(*arrays))
    assert isinstance(error.value, (bk.Error, ValueError))


def test_a_row_with_a_nan_is_left_out_and_said(arrays, command, tmp_path):
    """As in an npz archive of the same arrays, which the command reads."""
    t, u, x = (column.copy() for column in arrays)
    x[1000], u[3000], x[5000] = np.nan, np.inf, -np.inf
    np.savez(tmp_path / "a.npz", t=t, u=u, x=x)
    said = command("identify", tmp_path / "a.npz", "--json")
    found = bk.identify(t, u, x)
    assert [found.b.value, found.c.value] == [said["b"]["value"], said["c"]["value"]]
    rec = bk.recording(t, u, x)
    assert len(rec) == len(t) - 3
    assert any("3 " in remark.text for remark in found.remarks if remark.kind == "warning"), found.remarks
    masked = np.ma.masked_array(arrays[2], mask=np.isnan(x))
    assert len(bk.recording(arrays[0], arrays[1], masked)) == len(t) - 1
    with pytest.raises(bk.RecordingError):
        bk.identify(t, u, np.full_like(x, np.nan))


def test_a_clock_that_is_none_is_refused(arrays):
    t, u, x = arrays
    with pytest.raises(bk.RecordingError, match="too short"):
        bk.identify(t[:5], u[:5], x[:5])
    with pytest.raises(bk.RecordingError, match="^arrays"):
        bk.recording(np.zeros_like(t), u, x)


def test_columns_come_out_read_only_and_unchanged(arrays):
    rec = bk.recording(*arrays, units=("V", "rad"), encoder_step=1e-3)
    for name, column in zip("tux", arrays):
        out = getattr(rec, name)
        assert out.dtype == np.float64 and not out.flags.writeable
        assert (out == column).all()
        # The same array each time: nothing is copied on the way out.
        assert getattr(rec, name) is out
        with pytest.raises(ValueError):
            out.setflags(write=True)
    assert rec.units == ("V", "rad") and rec.encoder_step == 1e-3 and rec.current is None
    # What the caller does with the arrays afterwards changes nothing.
    mine = [column.copy() for column in arrays]
    kept = bk.recording(*mine)
    mine[2][:] = 0.0
    assert (kept.x == arrays[2]).all()


def test_the_current_is_read(arrays):
    """A winding of 2 Ω and a back-EMF of 0.05 V·s/rad, from which the drive is u = 2·i + 0.05·v."""
    t, u, x = arrays
    v = np.gradient(x, t)
    i = (u - 0.05 * v) / 2.0
    found = bk.identify((t, u, x, i), units=("V", "rad"))
    assert found.winding is not None
    # v is taken from positions of 1e-3 rad by differences; R is known far better than 2 %.
    assert found.winding.resistance.value == pytest.approx(2.0, rel=0.02)
    assert bk.recording(t, u, x, current=i).current.shape == t.shape


def test_a_drive_of_ones_own():
    """The applied drive is the array's, tick by tick, and the same seed gives the same numbers."""
    u = drive(2.0)
    run = bk.simulate(MODEL, u, noise=1e-4, seed=3)
    assert (run.recording.u == u).all() and len(run.recording) == 2000
    assert (run.recording.x == bk.simulate(MODEL, u, noise=1e-4, seed=3).recording.x).all()
    assert (run.recording.x != bk.simulate(MODEL, u, noise=1e-4, seed=4).recording.x).any()
    # The noise is 1e-4 to within 5 %: of 2000 numbers the deviation is known to 1.6 %.
    assert np.std(run.recording.x - run.true_x) == pytest.approx(1e-4, rel=0.05)
    with pytest.raises(bk.ArrayError, match=r"u\[7\] is NaN"):
        bk.simulate(MODEL, np.where(np.arange(2000) == 7, np.nan, u))
    with pytest.raises(bk.SimulateError, match="8 to 1e8 samples"):
        bk.simulate(MODEL, u[:7])


def test_keywords_that_make_no_sense_are_refused(arrays, tmp_path):
    with pytest.raises(bk.UsageError, match="time: these name columns"):
        bk.identify(*arrays, time="t_s")
    with pytest.raises(bk.UsageError, match="give both"):
        bk.identify(arrays[0], arrays[1])
    with pytest.raises(bk.UsageError, match="wrap: expected a positive number"):
        bk.recording(*arrays, wrap="often")
    with pytest.raises(TypeError, match="unexpected keyword argument: tiem"):
        bk.identify(*arrays, tiem="t")
    with pytest.raises(bk.UsageError, match="threads"):
        bk.identify(*arrays, threads=0)
    with pytest.raises(bk.ArrayError, match="expected a file, a Recording"):
        bk.discover([3])
    mine = tmp_path / "mine.toml"
    mine.write_text("a = 1\n")
    with pytest.raises(bk.FileError, match="is there already"):
        MODEL.write(mine)
    MODEL.write(mine, force=True)
    assert bk.Model.read(mine) == MODEL


def test_a_model_is_checked():
    with pytest.raises(bk.ModelError, match="`b` is -1.0"):
        bk.Model.of(-1.0)
    with pytest.raises(bk.ModelError, match="cogging"):
        bk.Model.of(1.0, effects=[{"name": "coging", "A": 1.0}])
    assert bk.Model.parse(MODEL.toml) == MODEL
    assert bk.Model.of(MODEL.b, MODEL.c, MODEL.f1, effects=MODEL.effects, units=("V", "rad")) == MODEL
    with pytest.raises(AttributeError):
        MODEL.b = 2.0
