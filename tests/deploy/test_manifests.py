"""What `deploy` has for Compose, Kubernetes and Slurm, checked by the schemas of these systems.

The kind RayCluster has no schema in a package: its pods are checked as pods, and its own fields by
name.
"""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import kubernetes_validate
import pytest
import yaml

from drivora_service.settings import Settings

_COMPOSE = ("postgresql", "ray", "sqlite")
_KUBERNETES = ("common", "ray", "servers")
_RAY_CLUSTER = {"rayVersion", "headGroupSpec", "workerGroupSpecs"}
_NODES = {"groupName", "replicas", "minReplicas", "maxReplicas", "rayStartParams", "template"}
_OF_RAY = {"DRIVORA_EXECUTOR", "DRIVORA_RAY_ADDRESS"}
"""Settings of the executor of a Ray cluster."""


@pytest.fixture
def deploy(repository: Path) -> Path:
    return repository / "deploy"


def test_no_manifest_is_left_out(deploy: Path) -> None:
    assert {path.stem for path in (deploy / "compose").glob("*.yaml")} == set(_COMPOSE)
    assert {path.stem for path in (deploy / "kubernetes").glob("*.yaml")} == set(_KUBERNETES)


@pytest.mark.parametrize("name", _COMPOSE)
def test_compose_files_have_the_form_of_compose(deploy: Path, name: str) -> None:
    command = [sys.executable, "-m", "check_jsonschema", "--builtin-schema", "vendor.compose-spec"]
    file = deploy / "compose" / f"{name}.yaml"
    done = subprocess.run([*command, str(file)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("name", _COMPOSE)
def test_compose_files_name_what_is_there(deploy: Path, name: str) -> None:
    content = yaml.safe_load((deploy / "compose" / f"{name}.yaml").read_text())
    for service in content["services"].values():
        if "build" in service:
            assert (deploy / "compose" / service["build"]["context"] / "Dockerfile").is_file()
        for volume in service.get("volumes", ()):
            source = volume.split(":")[0]
            if source.startswith("."):
                assert (deploy / "compose" / source).is_file()
            else:
                assert source in content["volumes"]
        for needed in service.get("depends_on", {}):
            assert "healthcheck" in content["services"][needed]


def test_the_proxy_knows_all_servers(deploy: Path) -> None:
    content = yaml.safe_load((deploy / "compose" / "postgresql.yaml").read_text())
    servers = {name for name in content["services"] if name.startswith("server-")}
    proxy = (deploy / "compose" / "Caddyfile").read_text()
    assert {found[:-5] for found in re.findall(r"server-\d+:8000", proxy)} == servers


@pytest.mark.parametrize("version", ["1.29", "1.37"])
@pytest.mark.parametrize("name", _KUBERNETES)
def test_kubernetes_manifests_have_the_form_of_their_kinds(
    deploy: Path, name: str, version: str
) -> None:
    for resource in manifests(deploy, name):
        if resource["kind"] != "RayCluster":
            kubernetes_validate.validate(resource, version, strict=True)
            continue
        assert resource["apiVersion"] == "ray.io/v1"
        spec = resource["spec"]
        assert spec.keys() == _RAY_CLUSTER
        assert spec["headGroupSpec"].keys() == {"rayStartParams", "template"}
        assert all(group.keys() == _NODES for group in spec["workerGroupSpecs"])
        for group in (spec["headGroupSpec"], *spec["workerGroupSpecs"]):
            assert all(isinstance(value, str) for value in group["rayStartParams"].values())
            metadata = {**group["template"]["metadata"], "name": "node"}
            pod = {"apiVersion": "v1", "kind": "Pod", "metadata": metadata}
            pod["spec"] = group["template"]["spec"]
            kubernetes_validate.validate(pod, version, strict=True)


def test_a_wrong_manifest_is_noticed(deploy: Path) -> None:
    (server,) = (one for one in manifests(deploy, "servers") if one["kind"] == "Deployment")
    server["spec"]["template"]["spec"]["containers"][0]["readynessProbe"] = {}
    with pytest.raises(kubernetes_validate.ValidationError, match="readynessProbe"):
        kubernetes_validate.validate(server, "1.37", strict=True)


@pytest.mark.parametrize("name", ["servers", "ray"])
def test_servers_are_probed_and_run_as_the_user_of_the_image(
    deploy: Path, name: str, repository: Path
) -> None:
    (server,) = (one for one in manifests(deploy, name) if one["kind"] == "Deployment")
    pod = server["spec"]["template"]["spec"]
    (container,) = pod["containers"]
    assert container["livenessProbe"]["httpGet"]["path"] == "/healthz"
    assert container["readinessProbe"]["httpGet"]["path"] == "/readyz"
    user = pod["securityContext"]["runAsUser"]
    assert f"--uid {user} drivora" in (repository / "Dockerfile").read_text()
    # Kubernetes would set variables such as DRIVORA_PORT for the Service of this name.
    assert pod["enableServiceLinks"] is False


@pytest.mark.parametrize("name", ["servers", "ray"])
def test_manifests_of_kubernetes_fit_together(deploy: Path, name: str) -> None:
    common = {one["kind"]: one for one in manifests(deploy, "common")}
    claim, service = common["PersistentVolumeClaim"], common["Service"]
    assert claim["spec"]["accessModes"] == ["ReadWriteMany"]
    (server,) = (one for one in manifests(deploy, name) if one["kind"] == "Deployment")
    template = server["spec"]["template"]
    assert service["spec"]["selector"].items() <= template["metadata"]["labels"].items()
    assert (
        server["spec"]["selector"]["matchLabels"].items() <= template["metadata"]["labels"].items()
    )
    (port,) = template["spec"]["containers"][0]["ports"]
    assert service["spec"]["ports"][0]["targetPort"] == port["name"]
    claims = set(values(manifests(deploy, name), "claimName"))
    assert claims == {claim["metadata"]["name"]}


def test_settings_that_manifests_name_exist(deploy: Path) -> None:
    known = {f"DRIVORA_{name.upper()}" for name in Settings.model_fields} | _OF_RAY
    # Of Compose, for its file `.env`.
    known |= {"DRIVORA_DATABASE_PASSWORD", "DRIVORA_MEMORY"}
    # Of the script for Slurm.
    known |= {"DRIVORA_ENVIRONMENT"}
    for folder in ("compose", "kubernetes", "slurm"):
        for path in (deploy / folder).iterdir():
            named = set(re.findall(r"\bDRIVORA_[A-Z_]+\b", path.read_text()))
            assert {one for one in named if not one.endswith("_")} <= known, path


def test_one_version_of_ray_is_named(deploy: Path) -> None:
    texts = [path.read_text() for path in deploy.rglob("*") if path.suffix in (".yaml", ".md")]
    named = {
        found for text in texts for found in re.findall(r"ray(?:\[default\])?==([\d.]+\d)", text)
    }
    (cluster,) = (one for one in manifests(deploy, "ray") if one["kind"] == "RayCluster")
    assert named == {cluster["spec"]["rayVersion"]}


def test_shell_scripts_have_no_finding(deploy: Path) -> None:
    scripts = [*deploy.rglob("*.sh"), *deploy.rglob("*.sbatch")]
    assert len(scripts) == 2
    for script in scripts:
        subprocess.run(["bash", "-n", str(script)], check=True)
    shellcheck = Path(sys.executable).parent / "shellcheck"
    done = subprocess.run(
        [str(shellcheck), *map(str, scripts)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout


# The programs of Slurm and Ray on one machine: steps are processes, the cluster is a file.
_SLURM = {
    "scontrol": 'printf "node-1\\nnode-2\\nnode-3\\n"',
    "srun": """
        while [ "${1#--}" != "$1" ]; do shift; done
        exec "$@"
    """,
    # As on Debian, where the name of a machine is that of a loopback address.
    "hostname": '[ "$1" = --ip-address ] && echo 127.0.1.1 || echo "fe80::1 10.0.0.1 10.0.1.1"',
    "ray": """
        case "$*" in
          "start --head"*) touch "$JOB/head" ;;
          health-check*) exec test -e "$JOB/head" ;;
        esac
        echo "$*" >> "$JOB/ray"
        exec sleep 600
    """,
    "drivora": """
        echo "$* $DRIVORA_EXECUTOR $DRIVORA_RAY_ADDRESS" > "$JOB/drivora"
        trap 'echo paused >> "$JOB/drivora"; kill $!; exit 3' TERM
        sleep "${SECONDS_OF_WORK:-0}" & wait
        exit 5
    """,
}


@pytest.fixture
def slurm(tmp_path: Path, deploy: Path) -> Iterator[dict[str, Any]]:
    """How to run the script in a job of three nodes."""
    programs = tmp_path / "environment" / "bin"
    programs.mkdir(parents=True)
    for name, script in _SLURM.items():
        (programs / name).write_text(f"#!/usr/bin/env bash\n{script}\n")
        (programs / name).chmod(0o755)
    variables = {
        "PATH": "/usr/bin:/bin",
        "HOME": str(tmp_path),
        "JOB": str(tmp_path),
        "DRIVORA_ENVIRONMENT": str(tmp_path / "environment"),
        "SLURM_JOB_ID": "4711",
        "SLURM_JOB_NODELIST": "node-[1-3]",
        "SLURM_JOB_NUM_NODES": "3",
        "SLURM_CPUS_PER_TASK": "16",
    }
    yield {"cwd": tmp_path, "env": variables, "text": True}
    left = subprocess.run(["pgrep", "-f", str(tmp_path)], capture_output=True, text=True)
    assert not left.stdout


def test_the_slurm_script_starts_a_cluster_and_a_campaign(
    slurm: dict[str, Any], deploy: Path, tmp_path: Path
) -> None:
    # The other nodes are started meanwhile.
    slurm["env"]["SECONDS_OF_WORK"] = "5"
    script = deploy / "slurm" / "drivora.sbatch"
    command = ["bash", str(script), "campaign", "run", "c.yaml", "--out", "found"]
    done = subprocess.run(command, timeout=60, check=False, **slurm)
    # Of the campaign.
    assert done.returncode == 5
    address = "10.0.0.1:24711"
    assert (tmp_path / "drivora").read_text() == (
        f"campaign run c.yaml --out found ray {address}\n"
    )
    head, nodes = (tmp_path / "ray").read_text().splitlines()
    assert "--node-ip-address=10.0.0.1 --port=24711 --num-cpus=14" in head
    assert nodes.startswith(f"start --address={address} --num-cpus=16")


def test_the_time_limit_of_slurm_pauses_the_campaign(
    slurm: dict[str, Any], deploy: Path, tmp_path: Path
) -> None:
    slurm["env"]["SECONDS_OF_WORK"] = "600"
    script = deploy / "slurm" / "drivora.sbatch"
    job = subprocess.Popen(["bash", str(script), "campaign", "resume", "some-id"], **slurm)
    ends = time.monotonic() + 60
    while not (tmp_path / "drivora").is_file() or not (tmp_path / "drivora").read_text():
        assert time.monotonic() < ends
        time.sleep(0.05)
    job.send_signal(signal.SIGTERM)
    assert job.wait(60) == 3
    assert (tmp_path / "drivora").read_text().endswith("paused\n")


def test_the_slurm_script_wants_a_command(slurm: dict[str, Any], deploy: Path) -> None:
    script = deploy / "slurm" / "drivora.sbatch"
    done = subprocess.run(
        ["bash", str(script)], timeout=60, check=False, stderr=subprocess.PIPE, **slurm
    )
    assert done.returncode == 1
    assert "the command of drivora: campaign, study" in done.stderr


def manifests(deploy: Path, name: str) -> list[dict[str, Any]]:
    """Returns the resources of a file."""
    return list(yaml.safe_load_all((deploy / "kubernetes" / f"{name}.yaml").read_text()))


def values(part: Any, key: str) -> Iterator[Any]:
    """Yields the values of a key at any depth."""
    if isinstance(part, dict):
        for name, value in part.items():
            if name == key:
                yield value
            yield from values(value, key)
    elif isinstance(part, list):
        for one in part:
            yield from values(one, key)
