#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Whether armsig-node makes the servo's ticks later: with_broker fleet_lateness_test.py ARMSIGD ARMSIG_NODE CONFIGURATION

One controller in real time about an emulated arm, and one node beside it, which runs and is held still in turn: the ticks of
both times are counted by the controller's own histogram.
"""
import os
import re
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "web"))
from cabinet import Cabinet, wait_for  # noqa: E402

armsigd, node, configuration = (os.path.abspath(word) for word in sys.argv[1:4])
port = os.environ["ARMSIG_BROKER_PORT"]
TURNS = 6      # of each kind
TURN_S = 1.5
TRIES = 3      # other work comes and goes; the same at least once
ONE_BIN = 2.0  # bins end at 1, 2, 4, ... us


class RealTime(Cabinet):
    def __init__(self, folder):
        super().__init__(armsigd, configuration, folder, 1)
        at = self.words.index("--speed")
        self.words[at:at + 2] = ["--real-time"]

    def counts(self):
        """How many ticks were late by up to 1, 2, 4, ... us, and the sum of all, in us."""
        status = self.ask("status")[0]
        bins = [int(count) for count in re.search(r" late_bins=([0-9,]+)", status)[1].split(",")]
        mean = float(re.search(r" late_mean_us=([0-9.]+)", status)[1])
        return bins, mean * sum(bins)


def quantile(bins, share):
    """Within its bin by proportion, in us."""
    left = share * sum(bins)
    for i, count in enumerate(bins):
        if left <= count and count > 0:
            low = 0 if i == 0 else 2.0 ** (i - 1)
            return low + (2.0 ** i - low) * left / count
        left -= count
    return float("inf")


def turn(cabinet, sums):
    before, late_before = cabinet.counts()
    time.sleep(TURN_S)
    after, late_after = cabinet.counts()
    for i, (a, b) in enumerate(zip(after, before)):
        sums[0][i] += a - b
    sums[1] += late_after - late_before


def measured(cabinet, process):
    sums = {"with": [[0] * 32, 0.0], "without": [[0] * 32, 0.0]}
    for _ in range(TURNS):
        process.send_signal(signal.SIGCONT)
        turn(cabinet, sums["with"])
        process.send_signal(signal.SIGSTOP)
        turn(cabinet, sums["without"])
    process.send_signal(signal.SIGCONT)
    said = {}
    for kind, (bins, late) in sums.items():
        said[kind] = (late / sum(bins), quantile(bins, 0.5), quantile(bins, 0.99))
        print("{} the node: {} ticks late by {:.1f} us in the mean, {:.1f} in the median, {:.1f} at 99 %".format(
            kind, sum(bins), *said[kind]))
    ratios = [said["with"][k] / said["without"][k] for k in range(3)]
    print("with over without: mean {:.2f}, median {:.2f}, 99 % {:.2f}".format(*ratios))
    return max(ratios[1:])


def main():
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["mosquitto_pub", "-p", port, "-r", "-q", "1", "-t", "spBv1.0/STATE/fleet", "-m",
                        f'{{"online":true,"timestamp":{int(time.time() * 1000)}}}'], check=True)
        cabinet = RealTime(folder)
        cabinet.start()
        with open(os.path.join(folder, "node.yaml"), "w") as file:
            file.write(f"armsig: node/1\nconsole: {cabinet.console}\njournal: {folder}/journal\njournal_mib: 1\ngroup: plant\n"
                       f"node: arm-1\nhost: fleet\nperiod_s: 1\nbroker: {{address: 127.0.0.1, port: {port}}}\n")
        heard = subprocess.Popen(["mosquitto_sub", "-p", port, "-t", "spBv1.0/plant/NDATA/arm-1", "-F", "%t"],
                                 stdout=subprocess.PIPE)
        process = subprocess.Popen([node, f"{folder}/node.yaml"])
        try:
            heard.stdout.readline()  # it reports
            wait_for(lambda: sum(cabinet.counts()[0]) > 100)
            return 0 if any(measured(cabinet, process) <= ONE_BIN for _ in range(TRIES)) else 1
        finally:
            process.send_signal(signal.SIGCONT)
            process.terminate()
            process.wait(30)
            heard.kill()
            heard.wait()
            heard.stdout.close()
            cabinet.stop()


if __name__ == "__main__":
    sys.exit(main())
