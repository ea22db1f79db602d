from __future__ import annotations

import json
import math

import numpy as np

from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.runs.report_encoding import report_from_json, report_to_json
from drivora_service.runs.run_report import RunFailure, RunReport, RunStatus


def test_a_report_comes_back_as_it_went() -> None:
    report = RunReport(
        run_id="run",
        status=RunStatus.FINISHED,
        verdicts=(
            Verdict(
                oracle="collision",
                ego="ego",
                outcome=Outcome.VIOLATED,
                message="hit the car",
                at_fault=True,
                time=1.25,
                step=25,
                location=(1.0, -2.0),
                counterpart="car",
                evidence={"speed": 3.5, "cells": [1, 2]},
            ),
        ),
        metrics={"speed": 1.5, "gap": None},
        step_cost_us=120.0,
        agent_cost_us={"ego": 30.5},
        privileged=("ego",),
        failure=RunFailure(cause="none", message="übel", log="a\nb"),
        versions={"libsumo": "1.28.0"},
    )
    assert report_from_json(report_to_json(report)) == report


def test_a_report_of_before_agents_were_timed_is_read() -> None:
    stored = json.loads(report_to_json(RunReport(run_id="run", status=RunStatus.FINISHED)))
    del stored["agent_cost_us"], stored["privileged"]
    read = report_from_json(json.dumps(stored))
    assert (read.agent_cost_us, read.privileged) == ({}, ())


def test_numpy_values_and_nan_become_plain_json() -> None:
    verdict = Verdict(
        oracle="o",
        ego="e",
        outcome=Outcome.NOT_MEASURABLE,
        message="m",
        evidence={"f": np.float32(0.5), "i": np.int64(3), "a": np.array([1.0, 2.0]), "n": np.nan},
    )
    report = RunReport(
        run_id="run", status=RunStatus.FINISHED, verdicts=(verdict,), metrics={"x": math.inf}
    )
    stored = json.loads(report_to_json(report))
    assert stored["verdicts"][0]["evidence"] == {"f": 0.5, "i": 3, "a": [1.0, 2.0], "n": None}
    assert stored["metrics"] == {"x": None}
