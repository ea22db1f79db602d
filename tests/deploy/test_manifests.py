"""What `deploy` has for Compose, Kubernetes and Slurm, checked by the schemas of these systems.

The kind RayCluster has no schema in a package: its pods are checked as pods, and its own fields by
name.
"""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import kubernetes_validate
import psutil
import pytest
import yaml

from drivora_service.settings import Settings
from tests.reverse_proxies import find_proxy

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


@pytest.mark.skipif(find_proxy("caddy") is None, reason="Caddy is not on this machine")
def test_the_file_of_the_proxy_can_be_used(deploy: Path) -> None:
    program = find_proxy("caddy")
    assert program is not None
    file = deploy / "compose" / "Caddyfile"
    command = [program, "validate", "--config", str(file), "--adapter", "caddyfile"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", [*_COMPOSE, "servers", "ray of Kubernetes"])
def test_every_form_takes_a_public_address(deploy: Path, name: str) -> None:
    if name in _COMPOSE:
        services = yaml.safe_load((deploy / "compose" / f"{name}.yaml").read_text())["services"]
        servers = [one for one in services if one == "drivora" or one.startswith("server-")]
        assert servers
        for server in servers:
            given = services[server]["environment"]["DRIVORA_PUBLIC_URL"]
            assert given == "${DRIVORA_PUBLIC_URL:-}"
        return
    (server,) = (one for one in manifests(deploy, name.split()[0]) if one["kind"] == "Deployment")
    (container,) = server["spec"]["template"]["spec"]["containers"]
    variables = {one["name"]: one.get("value") for one in container["env"]}
    assert variables["DRIVORA_PUBLIC_URL"] == ""


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
    known |= {"DRIVORA_DATABASE_PASSWORD", "DRIVORA_MEMORY", "DRIVORA_RAY_TOKEN"}
    # Of the script for Slurm.
    known |= {"DRIVORA_ENVIRONMENT"}
    for folder in ("compose", "kubernetes", "slurm", "systemd"):
        for path in (deploy / folder).iterdir():
            named = set(re.findall(r"\bDRIVORA_[A-Z_]+\b", path.read_text()))
            assert {one for one in named if not one.endswith("_")} <= known, path


def test_one_version_of_ray_is_named(deploy: Path, repository: Path) -> None:
    texts = [path.read_text() for path in deploy.rglob("*") if path.suffix in (".yaml", ".md")]
    named = {
        found for text in texts for found in re.findall(r"ray(?:\[default\])?==([\d.]+\d)", text)
    }
    (cluster,) = (one for one in manifests(deploy, "ray") if one["kind"] == "RayCluster")
    assert named == {cluster["spec"]["rayVersion"]}
    # That by which the tests of the executor start their clusters.
    tested = re.findall(
        r"^ray==([\d.]+)", (repository / "requirements" / "dev.txt").read_text(), re.M
    )
    assert named == set(tested)


def test_only_nodes_reach_the_ports_of_ray(deploy: Path) -> None:
    resources = manifests(deploy, "ray")
    (server,) = (one for one in resources if one["kind"] == "Deployment")
    (cluster,) = (one for one in resources if one["kind"] == "RayCluster")
    policies = {
        one["metadata"]["name"]: one["spec"] for one in resources if one["kind"] == "NetworkPolicy"
    }
    assert all(one["policyTypes"] == ["Ingress"] for one in policies.values())
    # The label that the operator gives the pods, and names that it does not use for its policies.
    nodes = {"matchLabels": {"ray.io/cluster": cluster["metadata"]["name"]}}
    servers = {"matchLabels": server["spec"]["template"]["metadata"]["labels"]}
    assert policies.keys() == {"drivora-ray", "drivora-server"}
    assert policies["drivora-ray"]["podSelector"] == nodes
    assert policies["drivora-ray"]["ingress"] == [
        {"from": [{"podSelector": nodes}, {"podSelector": servers}]}
    ]
    assert policies["drivora-server"]["podSelector"] == servers
    assert policies["drivora-server"]["ingress"] == [
        {"from": [{"podSelector": nodes}]},
        {"ports": [{"port": "http"}]},
    ]
    # Its page runs what it is told to.
    assert cluster["spec"]["headGroupSpec"]["rayStartParams"]["include-dashboard"] == "false"
    compose = yaml.safe_load((deploy / "compose" / "ray.yaml").read_text())
    assert "--include-dashboard=false" in compose["services"]["head"]["command"]


def test_all_parts_of_a_ray_cluster_have_its_token(deploy: Path) -> None:
    services = yaml.safe_load((deploy / "compose" / "ray.yaml").read_text())["services"]
    tokens = {name: one["environment"]["RAY_AUTH_TOKEN"] for name, one in services.items()}
    assert tokens.keys() == {"head", "node", "drivora"}
    # Without one, Compose says what to do.
    assert all(re.fullmatch(r"\$\{DRIVORA_RAY_TOKEN:\?.*\}", one) for one in tokens.values())
    assert all(one["environment"]["RAY_AUTH_MODE"] == "token" for one in services.values())

    containers = [one for found in values(manifests(deploy, "ray"), "containers") for one in found]
    assert {one["name"] for one in containers} == {"ray-head", "ray-node", "drivora"}
    for container in containers:
        variables = {one["name"]: one for one in container["env"]}
        assert variables["RAY_AUTH_MODE"]["value"] == "token"
        secret = {"secretKeyRef": {"name": "drivora", "key": "ray-token"}}
        assert variables["RAY_AUTH_TOKEN"]["valueFrom"] == secret
    # The keys of the secret that the page makes are those that are asked for.
    page = (deploy / "README.md").read_text()
    asked = {
        secret["key"]
        for name in ("servers", "ray")
        for secret in values(manifests(deploy, name), "secretKeyRef")
    }
    assert set(re.findall(r"--from-literal=([\w-]+)=", page)) == asked


_RAY_MIB = 2048
"""What Ray takes on a node, with its object store and the process of the slots."""


def test_the_memory_of_nodes_suffices_for_all_limits_of_drivora(deploy: Path) -> None:
    services = yaml.safe_load((deploy / "compose" / "ray.yaml").read_text())["services"]
    limits = services["drivora"]["environment"]
    options = dict(
        one.removeprefix("--").split("=", 1) for one in services["node"]["command"] if "=" in one
    )
    assert mib(default(services["node"]["mem_limit"])) == needed_mib(
        int(default(options["num-cpus"])),
        limits["DRIVORA_MEMORY_LIMIT_MB"],
        limits["DRIVORA_AGENT_MEMORY_MB"],
    )
    for service in services.values():
        assert "mem_limit" in service
        command = " ".join(service["command"])
        (store,) = re.findall(r"--object-store-memory=(\d+)", command)
        assert int(store) <= mib(service["shm_size"]) << 20

    resources = manifests(deploy, "ray")
    (server,) = (one for one in resources if one["kind"] == "Deployment")
    (cluster,) = (one for one in resources if one["kind"] == "RayCluster")
    (container,) = server["spec"]["template"]["spec"]["containers"]
    variables = {one["name"]: one.get("value") for one in container["env"]}
    (group,) = cluster["spec"]["workerGroupSpecs"]
    (node,) = group["template"]["spec"]["containers"]
    assert mib(node["resources"]["limits"]["memory"]) == needed_mib(
        int(group["rayStartParams"]["num-cpus"]),
        int(variables["DRIVORA_MEMORY_LIMIT_MB"]),
        int(variables["DRIVORA_AGENT_MEMORY_MB"]),
    )
    for part in (cluster["spec"]["headGroupSpec"], group):
        assert int(part["rayStartParams"]["object-store-memory"]) << 2 < _RAY_MIB << 20
    # The limits of the manifests are those of the service that is not told any.
    assert Settings.model_fields["memory_limit_mb"].default == limits["DRIVORA_MEMORY_LIMIT_MB"]
    assert Settings.model_fields["agent_memory_mb"].default == limits["DRIVORA_AGENT_MEMORY_MB"]
    page = (deploy / "README.md").read_text()
    assert "`4 * (2048 + 4096) + 2048` MiB = 26 GiB" in page
    assert needed_mib(4, 2048, 4096) == 26 << 10


def needed_mib(slots: int, worker_mib: int, ads_mib: int) -> int:
    """Returns the memory of a node whose workers and ADSs all use what they may."""
    return slots * (worker_mib + ads_mib) + _RAY_MIB


def mib(size: str) -> int:
    """Returns a size as Compose or Kubernetes writes it."""
    number, unit = re.fullmatch(r"(\d+)(g|Gi|m|Mi)", size).groups()  # type: ignore[union-attr]  # None fails the test
    return int(number) << (10 if unit[0].lower() == "g" else 0)


def default(value: str) -> str:
    """Returns the value of a variable of Compose that is not set."""
    return re.sub(r"\$\{\w+:-(.*)\}", r"\1", value)


def test_the_image_tells_ray_what_nodes_need(repository: Path, deploy: Path) -> None:
    last = (repository / "Dockerfile").read_text().rpartition("\nFROM ")[2]
    page = (repository / "docs" / "how-to" / "use-a-cluster.md").read_text()
    wanted = {"USAGE_STATS_ENABLED", "worker_niceness", "memory_monitor_refresh_ms"}
    assert set(re.findall(r"RAY_(\w+)=0\b", last)) == wanted
    exported = re.findall(r"export (RAY_USAGE.*)", page)
    assert len(exported) == 3
    for line in exported:
        assert set(re.findall(r"RAY_(\w+)=0\b", line)) == wanted
    # Nothing in the manifests takes it back.
    others = {"DRIVORA_RAY_ADDRESS", "DRIVORA_RAY_TOKEN", "RAY_AUTH_MODE", "RAY_AUTH_TOKEN"}
    for path in (deploy / "compose" / "ray.yaml", deploy / "kubernetes" / "ray.yaml"):
        assert set(re.findall(r"\w*RAY_\w+", path.read_text())) <= others


def commands_of_servers(deploy: Path) -> list[str]:
    """Returns what the servers with Ray run, for a shell."""
    compose = yaml.safe_load((deploy / "compose" / "ray.yaml").read_text())["services"]["drivora"]
    (server,) = (one for one in manifests(deploy, "ray") if one["kind"] == "Deployment")
    (container,) = server["spec"]["template"]["spec"]["containers"]
    assert compose["entrypoint"] == container["command"] == ["tini", "--", "sh", "-c"]
    # Compose replaces variables unless their sign is doubled.
    (in_compose,), (in_kubernetes,) = compose["command"], container["args"]
    return [in_compose.replace("$$", "$"), in_kubernetes]


def test_the_node_of_a_server_is_started_again_and_the_server_goes_on(
    deploy: Path, tmp_path: Path
) -> None:
    command, same = commands_of_servers(deploy)
    assert command == same
    programs = {
        "ray": 'echo "$*" >> "$JOB/ray"',
        "drivora": """
            echo "$*" >> "$JOB/drivora"
            trap 'echo stopped >> "$JOB/drivora"; exit 7' TERM
            while true; do sleep; done
        """,
        # The pause between two starts.
        "sleep": "exec /bin/sleep 0.1",
    }
    folder = tmp_path / "bin"
    folder.mkdir()
    for name, script in programs.items():
        (folder / name).write_text(f"#!/usr/bin/env bash\n{script}\n")
        (folder / name).chmod(0o755)
    variables = {
        "PATH": f"{folder}:/usr/bin:/bin",
        "JOB": str(tmp_path),
        "DRIVORA_RAY_ADDRESS": "head:6379",
    }
    server = subprocess.Popen(["sh", "-c", command], env=variables, start_new_session=True)
    try:
        until_lines(tmp_path / "ray", 3)
        until_lines(tmp_path / "drivora", 1)
        # The init of the container tells its only child.
        server.send_signal(signal.SIGTERM)
        assert server.wait(30) == 7
    finally:
        # As the end of a container does.
        os.killpg(server.pid, signal.SIGKILL)
    assert (tmp_path / "drivora").read_text() == "serve\nstopped\n"
    assert set((tmp_path / "ray").read_text().splitlines()) == {
        "start --address=head:6379 --num-cpus=0 --object-store-memory=209715200 --block"
    }


def until_lines(path: Path, count: int) -> None:
    """Waits until a file has that many lines."""
    ends = time.monotonic() + 60
    while not path.is_file() or path.read_text().count("\n") < count:
        assert time.monotonic() < ends
        time.sleep(0.05)


def test_shell_scripts_have_no_finding(deploy: Path) -> None:
    ci = deploy.parent / ".ci"
    scripts = [*deploy.rglob("*.sh"), *deploy.rglob("*.sbatch"), *ci.iterdir()]
    assert len(scripts) == 6
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
        echo "$RAY_AUTH_MODE $RAY_AUTH_TOKEN" >> "$JOB/tokens"
        exec sleep 600
    """,
    "drivora": """
        echo "$RAY_AUTH_MODE $RAY_AUTH_TOKEN" >> "$JOB/tokens"
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
    commands = [one.info["cmdline"] or () for one in psutil.process_iter(["cmdline"])]
    assert [command for command in commands if str(tmp_path) in " ".join(command)] == []


@pytest.mark.slow(seconds=15)
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
    # One token for all of this job, and no other.
    (token,) = {*(tmp_path / "tokens").read_text().splitlines()}
    assert re.fullmatch("token [0-9a-f]{64}", token)
    (tmp_path / "tokens").unlink()
    subprocess.run(command, timeout=60, check=False, **slurm)
    assert token not in (tmp_path / "tokens").read_text()


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
