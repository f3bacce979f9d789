"""What other libraries read of the files that `pneudrive export` writes."""

import math
import pathlib

import scipy.io
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

FIXTURES = pathlib.Path(__file__).parents[2] / "logs" / "tests" / "fixtures"


def test_scipy_reads_a_mat_file_as_columns() -> None:
    read = scipy.io.loadmat(FIXTURES / "two-samples.mat")
    assert read["time_s"].tolist() == [[-0.0013], [0.0]]
    assert read["position_m"].tolist() == [[0.1 + 0.2], [-1e-300]]
    assert math.isnan(read["spool_mm"][0, 0]) and read["spool_mm"][1, 0] == 0.5
    assert read["about"].tolist() == ["rig = servo-b\n"]


def test_the_reference_library_reads_an_mcap_file() -> None:
    with open(FIXTURES / "two-samples.mcap", "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        read = list(reader.iter_decoded_messages())
        summary = reader.get_summary()
        (about,) = reader.iter_metadata()
    assert [(found[1].topic, found[2].log_time) for found in read] == [("/drive", 0), ("/drive", 1_300_000)]
    first, second = (found[3] for found in read)
    assert (first.time_s, first.position_m, second.position_m) == (-0.0013, 0.1 + 0.2, -1e-300)
    assert math.isnan(first.spool_mm) and second.spool_mm == 0.5
    assert summary is not None and summary.statistics is not None
    assert summary.statistics.message_count == 2
    assert about.metadata == {"rig": "servo-b"}
