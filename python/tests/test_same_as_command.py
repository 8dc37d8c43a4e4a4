"""The numbers and the texts are the command's, to the last bit: both are the same library and the same document."""

import json
import pickle

import breakaway as bk
import numpy as np
import pytest
from conftest import ROOT


def without_time(document):
    """What does not differ from run to run, nor between the command and the package."""
    return {key: value for key, value in document.items() if key not in ("seconds", "provenance")}


def test_identify_on_a_measured_recording(measured, command):
    """EMPS (docs/case-studies.md): the file as the command reads it, and its columns as arrays."""
    file = measured("emps/emps_train.csv")
    columns = {"time": "t_s", "input": "u_V", "position": "x_m"}
    said = command("identify", file, "--json", *[word for k, v in columns.items() for word in (f"--{k}", v)])
    assert bk.identify(file, **columns).document == said
    t, u, x = np.loadtxt(file, delimiter=",", skiprows=1, usecols=(0, 1, 2), unpack=True)
    found = bk.identify(t, u, x, units=("V", "m"))
    assert {key: found.document[key] for key in ("b", "c", "f1", "load")} == {
        key: said[key] for key in ("b", "c", "f1", "load")
    }
    # Published: M = 95.1089 kg at 35.15065 N/V; within 0.3 % (README, "How good it is").
    assert found.b.value == pytest.approx(95.1089 / 35.15065, rel=3e-3)


def test_identify_on_a_generated_recording(arrays, command, tmp_path):
    """Arrays, the same arrays in a file of the package's, and the command on that file."""
    rec = bk.recording(*arrays, units=("V", "rad"))
    rec.write(tmp_path / "rec.csv")
    said = command("identify", tmp_path / "rec.csv", "--json")
    assert bk.identify(tmp_path / "rec.csv").document == said
    found = bk.identify(*arrays, units=("V", "rad"))
    for name in ("b", "c", "f1"):
        assert found.document[name] == said[name]
    # As .ci/stranger asks of the command: b within 5 % of 0.03, beside the ripple that the base lacks.
    assert found.b.value == pytest.approx(0.03, rel=0.05)


@pytest.fixture(scope="module")
def discovered(arrays, command, tmp_path_factory):
    folder = tmp_path_factory.mktemp("discover")
    bk.recording(*arrays, units=("V", "rad")).write(folder / "rec.csv")
    said = command("discover", folder / "rec.csv", "--json", "-o", folder / "m.toml", "--report", folder / "r.html")
    return folder, said, bk.discover(folder / "rec.csv")


def test_discover_gives_the_document_the_model_and_the_report(discovered):
    folder, said, found = discovered
    assert without_time(found.document) == without_time(said)
    assert [effect.name for effect in found.effects] == ["cogging"]
    assert found.model.toml == (folder / "m.toml").read_text()
    found.model.write(folder / "own.toml")
    assert (folder / "own.toml").read_text() == (folder / "m.toml").read_text()
    # The report states the time taken and the command line; all else is the same.
    stated = lambda page: [line for line in page.splitlines() if "time taken" not in line and "breakaway" not in line]
    assert stated(found.html) == stated((folder / "r.html").read_text())
    # Results go from process to process.
    assert pickle.loads(pickle.dumps(found)) == found
    assert "srcdoc=" in found._repr_html_() and "The model missed cogging" in found._repr_html_()


def test_discover_starts_from_a_model_and_takes_held_out_arrays(arrays, discovered):
    """With the ripple in the model there is nothing to name; a recording that is fitted cannot be held out."""
    _, _, found = discovered
    t, u, x = arrays
    half = len(t) // 2
    first, second = (t[:half], u[:half], x[:half]), (t[half:], u[half:], x[half:])
    again = bk.discover(first, holdout=second, model=found.model, units=("V", "rad"))
    assert again.effects == ()
    with pytest.raises(bk.RecordingError, match="arrays holds the same samples as") as error:
        bk.discover(first, holdout=first, units=("V", "rad"))
    assert error.value.kind == "given_twice"


def test_sinefit(command, tmp_path):
    """0.5·sin(3t + 0.2) + 1, with noise of a seed."""
    t = np.arange(0, 20, 0.01)
    x = 0.5 * np.sin(3 * t + 0.2) + 1 + 1e-3 * np.random.default_rng(1).standard_normal(len(t))
    fit = bk.sinefit(t, x)
    np.savetxt(tmp_path / "s.csv", np.column_stack([t, x]), delimiter=",", header="t,x", comments="", fmt="%.17g")
    said = command("sinefit", tmp_path / "s.csv", "--json")
    assert fit.document == said
    # Four standard errors: once in 16 000 for a wrong reason.
    assert abs(fit.omega - 3.0) < 4 * fit.se.omega and abs(fit.amplitude - 0.5) < 4 * fit.se.amplitude
    assert "omega" in fit._repr_html_()


def test_simulate_an_experiment(command, tmp_path):
    model = bk.Model.of(0.02685, 0.11, 0.5, units=("V", "rad"))
    model.write(tmp_path / "m.toml")
    tables = {"name": "relay", "duration_s": 2.0, "excitation": {"kind": "relay", "h1": 2.0, "h2": 1.5}}
    (tmp_path / "e.toml").write_text(
        'name = "relay"\nduration_s = 2.0\nexcitation = { kind = "relay", h1 = 2.0, h2 = 1.5 }\n'
    )
    said = command("simulate", "--model", tmp_path / "m.toml", "--experiment", tmp_path / "e.toml", "-o", tmp_path / "r.csv", "--json")
    assert said["samples"] == 2000
    text = (tmp_path / "e.toml").read_text()
    for drive in (tables, text, tmp_path / "e.toml", str(tmp_path / "e.toml")):
        run = bk.simulate(model, drive)
        run.recording.write(tmp_path / "own.csv")
        assert (tmp_path / "own.csv").read_bytes() == (tmp_path / "r.csv").read_bytes()
    assert run.tripped is None and run.true_x.shape == run.recording.x.shape


def test_export(command, tmp_path):
    model = bk.Model.of(0.02685, 0.11, 0.5, units=("V", "rad"), effects=[bk.Effect("constant_load", {"f0": 0.1})])
    model.write(tmp_path / "axis.toml")
    flags = ["--motor-constant", 0.05, "--resistance", 2.0]
    for target in ("mjcf", "urdf", "c"):
        said = command("export", tmp_path / "axis.toml", "--to", target, "--json", *flags)
        made = model.export(target, motor_constant=0.05, resistance=2.0)
        assert (made.text, list(made.lost)) == (said["text"], said["lost"])
        assert [part.what for part in made.parts] == [part["what"] for part in said["parts"]]
    said = command("export", tmp_path / "axis.toml", "--to", "mjcf")
    with pytest.raises(bk.ExportError) as error:
        model.export("mjcf")
    assert str(error.value) == said


@pytest.mark.parametrize(
    ("text", "family", "kind", "line"),
    [
        ("t,u,y\n0,1,2\n", bk.RecordingError, "wrong_column", 1),
        ("0,1,2\n3,4,5\n", bk.RecordingError, "no_header", 1),
        ("t,u,x\n0,1,2\n1,one,3\n2,1,2\n", bk.RecordingError, "not_a_number", 3),
        ("", bk.RecordingError, "empty", None),
        ("[base]\nb = 1\n", bk.FileError, "other_kind", None),
    ],
)
def test_an_error_has_the_text_of_the_command(text, family, kind, line, command, tmp_path):
    file = tmp_path / "rec.csv"
    file.write_text(text)
    said = command("identify", file)
    with pytest.raises(family) as error:
        bk.identify(file)
    assert str(error.value) == said
    assert isinstance(error.value, bk.Error)
    assert (error.value.kind, error.value.line, error.value.file) == (kind, line, str(file))


def test_other_families_have_the_text_of_the_command(arrays, command, tmp_path):
    (tmp_path / "m.toml").write_text("[base]\nb = -1\nc = 0\nf1 = 0\n")
    said = command("export", tmp_path / "m.toml", "--to", "c")
    with pytest.raises(bk.ModelError) as error:
        bk.Model.read(tmp_path / "m.toml")
    assert str(error.value) == said
    with pytest.raises(bk.FileError) as error:
        bk.read(tmp_path / "nothing.csv")
    assert str(error.value) == command("identify", tmp_path / "nothing.csv")
    assert isinstance(error.value, OSError)
    # An axis at rest determines nothing.
    bk.simulate(bk.Model.of(1.0, 0.1, 10.0), np.sin(np.arange(4000) * 0.01)).recording.write(tmp_path / "still.csv")
    with pytest.raises(bk.Error) as error:
        bk.identify(tmp_path / "still.csv")
    assert str(error.value) == command("identify", tmp_path / "still.csv")


def test_every_field_of_the_documents_is_a_field_of_the_results():
    """host/schema has the documents; a field that is new there is missing here, and the other way round."""
    kinds = {"identify": bk.Identification, "discover": bk.Discovery, "sinefit": bk.SineFit}
    own = {"model", "html", "document"}
    for name, kind in kinds.items():
        schema = json.loads((ROOT / f"host/schema/{name}.json").read_text())
        fields = {field.rstrip("_") for field in kind.__dataclass_fields__} - own
        assert fields == set(schema["properties"]), name
    parts = json.loads((ROOT / "host/schema/discover.json").read_text())["$defs"]
    for part, kind in {"RungJson": bk.Rung, "WhereJson": bk.Where, "ForceJson": bk.Force, "EffectJson": bk.FoundEffect,
                       "CandidateJson": bk.Candidate, "NextJson": bk.NextExperiment}.items():
        assert {field.rstrip("_") for field in kind.__dataclass_fields__} == set(parts[part]["properties"]), part
