"""The recorder on ROS: every topic of the graph into a bag in the layout of rosbag2.

    python -m biped_bag.recorder.node --ros-args -p folder:=DIR [-p NAME:=VALUE ...]

records until SIGINT or SIGTERM (settings.py lists the parameters). `log_time` is when
the middleware received a message and `publish_time` when its publisher sent it, both
wall clock, as rosbag2 of Jazzy has it; `sequence` is the publisher's own number. With
`sim_time`, `log_time` is the time of /clock. With `start_paused`, what comes is left
out until the service ~/resume is called.

What failures do:
    the folder is a bag already, cannot be written to, or the disk gets full: reported
        in the log and in /diagnostics, then the recorder ends with exit status 4.
    a wrong parameter: one line, exit status 2.
    a topic whose type is not installed: a warning; the others are recorded.
    kill -9: the bag has all but the last 0.2 s; storage/writer.py says in what state.
"""

from __future__ import annotations

import json
import sys
import time
from functools import partial
from pathlib import Path
from typing import Any

from diagnostic_msgs.msg import DiagnosticStatus
from mcap.records import Attachment
from std_srvs.srv import Trigger

from biped_bag.errors import BagError
from biped_bag.recorder.counts import counts_of, counts_table
from biped_bag.recorder.episodes import EpisodeRecords
from biped_bag.recorder.intake import Intake, listener_beside
from biped_bag.recorder.settings import RecorderSettings
from biped_bag.recorder.writer_thread import WriterThread
from biped_bag.records import (
    COMPLETE,
    COUNTS_RECORD,
    EPISODE_RECORD,
    LOST_KEY,
    RUN_RECORD,
    STATE_KEY,
)
from biped_bag.storage.contents import BagMessage, BagTopic
from biped_bag.storage.layout import fresh_folder
from biped_bag.storage.writer import BagWriter
from biped_bag.transforms import MadeTransforms
from biped_common.settings import SettingsError, from_json
from biped_common.terminal_text import printable
from biped_ros.guarded import GuardedNode
from biped_ros.link_transforms import TF
from biped_ros.running import run_node
from msgs_json import topics
from msgs_json.topics import Topic

NAME = topics.RECORDER_NODE
_TURN_S = 0.02
_LOOK_PERIOD_S = 0.1
# Long enough for the reason to get around before the node ends.
_FAREWELL_S = 1.5


class RecorderNode(GuardedNode):
    """Listens to everything, writes it down, and understands next to nothing of it."""

    def __init__(self, **options: Any) -> None:
        """Begin the bag; a bag that cannot be begun is reported as a failure.

        Args:
            options: of `rclpy.node.Node`, such as `parameter_overrides`.

        Raises:
            SettingsError: a parameter is wrong.
        """
        super().__init__(NAME, **options)
        self._settings = self.settings_from_parameters(RecorderSettings)
        if not self._settings.folder:
            raise SettingsError("folder", "", "must name the folder of the bag")
        selection = self._settings.selection()
        self._error = ""
        self._recording: WriterThread | None = None
        self._episodes = EpisodeRecords()
        self._waiting: list[BagMessage] = []
        self._listener = listener_beside(self)
        self._intake = Intake(
            self._listener,
            selection,
            self._announce,
            self.warn,
            sim_time=self._settings.sim_time,
        )
        self._transforms: MadeTransforms | None = None
        if self._settings.make_tf and selection.wants(TF.name, [TF.type_name]):
            self._intake.leave_out(TF.name)  # one publisher of each transform is enough
            self._transforms = MadeTransforms(self._announce, self.warn)
        if self._settings.start_paused:
            # For strangers on the graph only where it was asked for.
            self._intake.paused = True
            self.create_service(Trigger, "~/pause", partial(self._answer, True))
            self.create_service(Trigger, "~/resume", partial(self._answer, False))
        try:
            self._recording = self._begun()
        except (BagError, OSError) as error:
            self._stop_recording(str(error))
            return
        if self._settings.expect_biped:
            self._intake.expect(
                topic for topic in vars(topics).values() if isinstance(topic, Topic)
            )
        self.create_timer(_TURN_S, self._turn)
        self.create_timer(_LOOK_PERIOD_S, self._intake.look_around)

    def toggle_paused(self) -> bool:
        """Pause, or go on; return whether it is paused now."""
        self._hear()  # what came before belongs to what was before
        self._intake.paused = not self._intake.paused
        self.get_logger().info("Paused." if self._intake.paused else "Recording.")
        return self._intake.paused

    def close(self) -> None:
        """Write what has come, finish the bag, and say what was received and lost."""
        recording = self._recording
        if recording is not None:
            for _ in range(2):  # what came late in the first turn is there in the next
                self._hear()
            while self._waiting:
                self._pass_on()
            self._pass_on()  # the last walk's record
            incoming = self._intake.topics.values()

            def count(bag: BagWriter) -> None:
                counts = counts_of(incoming, bag).items()
                texts = {name: json.dumps(of_topic) for name, of_topic in counts}
                bag.add_record(COUNTS_RECORD, texts)

            recording.do(count)
            lost = sum(topic.continuity.lost for topic in incoming)
            state = str(recording.error or COMPLETE)
            recording.close({STATE_KEY: state, LOST_KEY: str(lost)})
            bag = recording.writer
            for line in counts_table(counts_of(incoming, bag), bag.folder):
                self.get_logger().info(printable(line))
        self._listener.destroy_node()
        if self._error:
            # The last word: the supervisor tells it on.
            print(f"recording stopped: {self._error}", file=sys.stderr)

    def figures(self) -> dict[str, str]:
        """Return how much has been received and lost."""
        incoming = self._intake.topics.values()
        return {
            "messages received": str(sum(topic.received for topic in incoming)),
            "messages lost": str(sum(topic.continuity.lost for topic in incoming)),
            "topics": str(sum(topic.announced for topic in incoming)),
        }

    def _answer(
        self, pause: bool, _: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        response.success = self._intake.paused != pause
        if response.success:
            self.toggle_paused()
        response.message = "paused" if self._intake.paused else "recording"
        return response

    def _begun(self) -> WriterThread:
        """Begin the bag.

        Raises:
            BagError: it cannot be begun.
            OSError: the attachment cannot be read.
            SettingsError: the run's data are no JSON object of texts.
        """
        settings = self._settings
        asked_for = Path(settings.folder).absolute()
        folder = fresh_folder(asked_for) if settings.number_if_taken else asked_for
        run = from_json("run", settings.run, dict[str, str])
        attached = []
        if folder != asked_for:
            # Begun in the middle of a run: the memory there is not the one begun with.
            run["continues"] = asked_for.name
        elif settings.attachment:
            attached.append(_attachment(Path(settings.attachment)))
        writer = BagWriter(
            folder,
            max_file_bytes=(
                settings.max_file_mb * 1_000_000 if settings.split == "size" else 0
            ),
            records={RUN_RECORD: run} if run else {},
        )
        for item in attached:
            writer.attach(item)
        self.get_logger().info(f"recording to {folder}")
        return WriterThread(writer)

    def _turn(self) -> None:
        if self._recording is None or self._error:
            return
        if self._recording.error is not None:
            self._stop_recording(str(self._recording.error))
            return
        self._hear()
        self._pass_on()

    def _hear(self) -> None:
        messages = self._intake.take()
        if self._transforms is not None:
            messages = self._transforms.put_in(messages)
        self._episodes.hear(messages)
        self._waiting += messages

    def _pass_on(self) -> None:
        """Have messages written, up to the end of a walk at most.

        What comes behind the end of a walk waits for one turn, so that the record of
        the walk, for which the learner's status is needed, is written before it.
        """
        recording = self._recording
        if recording is None:
            return
        record = self._episodes.record()
        if record is not None:
            settings, walks = self._settings, self._episodes.finished
            recording.do(lambda bag: bag.add_record(EPISODE_RECORD, record))
            if settings.split == "episode" and walks % settings.episodes_per_file == 0:
                end_ns = int(record["last_log_time"])
                recording.do(lambda bag: bag.split(end_ns))
        ready = self._episodes.follow(self._waiting)
        recording.put(self._waiting[:ready])
        del self._waiting[:ready]

    def _announce(self, topic: BagTopic) -> None:
        if self._recording is not None:
            self._recording.do(lambda bag: bag.add_topic(topic))

    def _stop_recording(self, reason: str) -> None:
        """Say why nothing is recorded any more, and end the node a little later."""
        self._error = reason
        self.get_logger().error(f"recording stopped: {reason}")
        self._publish_diagnostics()
        self.create_timer(_FAREWELL_S, self._give_up)

    def _give_up(self) -> None:
        self._publish_diagnostics()
        self.failure = self._error

    def _publish_diagnostics(self) -> None:
        if self._error:
            text = f"recording stopped: {self._error}"
            self.remark(DiagnosticStatus.ERROR, "recording", text)
        super()._publish_diagnostics()


def _attachment(file: Path) -> Attachment:
    """Return a file as it is kept in the bag.

    Raises:
        OSError: it cannot be read.
    """
    now_ns, kind = time.time_ns(), "application/octet-stream"
    return Attachment(now_ns, now_ns, file.name, kind, file.read_bytes())


def main() -> int:
    """Run the node as a process."""
    return run_node(RecorderNode)


if __name__ == "__main__":
    sys.exit(main())
