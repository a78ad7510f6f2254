"""Speed of log writing, reading and pages: `python -m benchmarks.files.review_speed`.

A simulated flight of ten minutes with six channels at 100 Hz, written and read beside the libraries' own
encoder and decoder in the same run; pages of ten and thirty minutes, opened in Chromium where there is one.
"""

import io
import re
import shutil
import subprocess
from collections.abc import Callable
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

import numpy as np
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass
from mcap.reader import make_reader
from mcap.writer import Writer

from experiments.campaign.fly_campaign import campaign_library
from flight.mission.sequence import Sequence
from flight.se2 import SE2
from flightlog.file.reader import read_log
from flightlog.file.writer import log_bytes, topic_descriptors
from flightlog.log import FlightLog
from flightlog.series import Series
from flightlog.topics import COMMAND, CONTROLS, ESTIMATE, NAVIGATION, TRUTH, WIND
from review.page.page import ReviewedFlight, review_page
from review.summary.summary import summarise
from scenarios.find import find_campaign
from sim.campaign_flight import fly_sequence
from sim.loop.specification import specify_sequence
from sim.simulated_helicopter import SimulatedHelicopter

TOPICS = (COMMAND, ESTIMATE, TRUTH, NAVIGATION, WIND, CONTROLS)
RATE, MINUTE = 100.0, 60.0
WALK = (1, 2, 3, 7, 5, 2) * 5
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


def main() -> None:
    """Prints the figures."""
    log = flight(10.0 * MINUTE)
    written, content = timed(lambda: log_bytes(log))
    stock_written, stock = timed(lambda: stock_bytes(log))
    ratio = stock_written / written
    print(f"write 10 minutes: {written:.2f} s CPU, {len(content) / 1e6:.1f} MB, viewers' channels in it")
    print(f"  stock encoder:  {stock_written:.2f} s CPU, {len(stock) / 1e6:.1f} MB: {ratio:.0f}x")
    with TemporaryDirectory() as name:
        folder = Path(name)
        path = folder / "flight.mcap"
        path.write_bytes(content)
        read, _ = timed(lambda: read_log(path))
        stock_read, _ = timed(lambda: stock_arrays(content))
        print(f"read 10 minutes:  {read:.2f} s CPU, every checksum verified")
        print(f"  stock decoder:  {stock_read:.2f} s CPU: {stock_read / read:.0f}x")
        for minutes in (10.0, 30.0):
            made, page = timed(partial(page_of, flight(minutes * MINUTE)))
            print(f"page of {minutes:.0f} minutes: {made:.2f} s CPU, {len(page) / 1e6:.1f} MB", end="")
            (folder / "page.html").write_text(page, encoding="utf-8")
            print(f", opens in {opening(folder):.2f} s" if CHROMIUM else ", no Chromium to open it")


def flight(duration: float) -> FlightLog:
    """Returns a flight with six channels sampled at `RATE`; duration in seconds."""
    library = campaign_library(find_campaign("gtmax"), "gtmax")
    coasts = (duration / len(WALK),) * len(WALK)
    sequence = Sequence("long", SE2.identity(), WALK, coasts, "gtmax")
    helicopter = SimulatedHelicopter(specify_sequence(sequence, seed=1), library)
    fly_sequence(helicopter, sequence, library=library)
    log = helicopter.log()
    time = np.arange(round(log.duration * RATE)) / RATE
    series = {}
    for topic in TOPICS:
        columns = [np.interp(time, log[topic].time, column) for column in log[topic].values.T]
        series[topic.name] = Series(topic, time, np.stack(columns, axis=1))
    return FlightLog(log.header, {**log.series, **series}, log.attachments)


def page_of(log: FlightLog) -> str:
    """Returns the page of a flight."""
    return review_page([ReviewedFlight(log, summarise(log), "flight")])


def timed(work: Callable[[], Any]) -> tuple[float, Any]:
    """Returns CPU seconds and the result."""
    began = process_time()
    result = work()
    return process_time() - began, result


def message_class(descriptors: bytes, name: str) -> Any:
    """Returns the runtime's class of a message."""
    pool = DescriptorPool()
    for file in FileDescriptorSet.FromString(descriptors).file:
        pool.Add(file)
    return GetMessageClass(pool.FindMessageTypeByName(name))


def stock_bytes(log: FlightLog) -> bytes:
    """Writes the same channels by the protobuf runtime and MCAP library."""
    stream = io.BytesIO()
    writer = Writer(stream, enable_data_crcs=True)
    writer.start()
    for topic in TOPICS:
        descriptors = topic_descriptors(topic)
        kind = message_class(descriptors, topic.message)
        schema = writer.register_schema(topic.message, "protobuf", descriptors)
        channel = writer.register_channel(topic.name, "protobuf", schema)
        series = log[topic]
        for time, row in zip(
            np.rint(series.time * 1e9).astype(int).tolist(), series.values.tolist(), strict=True
        ):
            message = kind(**dict(zip(topic.field_names, row, strict=True)))
            writer.add_message(channel, time, message.SerializeToString(), time)
    writer.finish()  # type: ignore[no-untyped-call]
    return stream.getvalue()


def stock_arrays(content: bytes) -> dict[str, np.ndarray]:
    """Reads the channels message by message into arrays."""
    rows: dict[str, list[list[float]]] = {topic.name: [] for topic in TOPICS}
    classes: dict[str, Any] = {}
    for schema, channel, message in make_reader(io.BytesIO(content)).iter_messages(topics=list(rows)):
        assert schema is not None
        kind = classes.setdefault(schema.name, None) or message_class(schema.data, schema.name)
        classes[schema.name] = kind
        decoded = kind.FromString(message.data)
        rows[channel.topic].append([getattr(decoded, field.name) for field in kind.DESCRIPTOR.fields])
    return {name: np.array(part) for name, part in rows.items()}


def opening(folder: Path) -> float:
    """Returns seconds from the page request to its first plots."""
    page = folder / "page.html"
    with page.open("a", encoding="utf-8") as file:
        file.write("<script>requestAnimationFrame(() => setTimeout(() => ")
        file.write("console.log(`drawn after ${performance.now()} ms`)));</script>")
    flags = ["--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr"]
    files = [f"--user-data-dir={folder / 'profile'}", f"--screenshot={folder / 'page.png'}", page.as_uri()]
    done = subprocess.run([str(CHROMIUM), *flags, *files], check=True, capture_output=True, text=True)
    (drawn,) = re.findall(r"drawn after ([0-9.]+) ms", done.stderr)
    return 1e-3 * float(drawn)


if __name__ == "__main__":
    main()
