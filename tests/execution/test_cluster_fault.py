"""When a cluster whose nodes come and go is of no use."""

from __future__ import annotations

from drivora_service.execution.ray.cluster_fault import ClusterFault
from drivora_service.execution.ray.ray_messages import Members


def test_a_cluster_without_nodes_is_a_fault_after_a_while() -> None:
    fault = ClusterFault("here:1")
    for now, found in ((0.0, False), (9.0, False), (11.0, True), (12.0, True)):
        assert bool(fault.look(Members(alive=()), {}, now)) is found
    assert fault.look(Members(alive=("one",)), {}, 13.0) == ""
    assert fault.look(Members(alive=()), {}, 14.0) == ""
    assert "here:1" in fault.look(Members(alive=()), {}, 30.0)


def test_a_fault_of_all_nodes_is_one_of_the_cluster() -> None:
    fault = ClusterFault("here:1")
    members = Members(alive=("one", "two"), unusable={"one": "another version"})
    # One that is starting, or well, is enough.
    assert fault.look(members, {}, 0.0) == fault.look(members, {"two": ""}, 1.0) == ""
    assert fault.look(members, {"two": "no library"}, 2.0) == "on the node one: another version"
