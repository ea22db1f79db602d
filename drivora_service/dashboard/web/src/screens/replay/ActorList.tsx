import { type Column, DataTable } from "../../components/DataTable";
import { fixed } from "../../components/numbers";
import type { Clock } from "./clock";
import type { PerceivedActors } from "./perception";
import type { Actor, Recording } from "./recording";
import { useStep } from "./useMoment";

const ROLES: Readonly<Record<Actor["role"], string>> = {
  ego: "ego",
  npc_vehicle: "NPC vehicle",
  npc_walker: "walker",
  npc_obstacle: "obstacle",
  background: "background",
};

/** Returns the token of an actor's colour. */
export function colourToken(actor: Actor): string {
  if (actor.role === "ego") return `var(--ego-${actor.row % 6})`;
  if (actor.role === "npc_walker") return "var(--walker)";
  if (actor.role === "npc_obstacle") return "var(--obstacle)";
  return "var(--npc)";
}

/** All actors at the time, with their distance to an ego; a row follows its actor. */
export function ActorList({
  recording,
  clock,
  ego,
  followed,
  hidden,
  perceived,
  onFollow,
  onHide,
}: {
  readonly recording: Recording;
  readonly clock: Clock;
  readonly ego: number;
  readonly followed: string;
  readonly hidden: readonly string[];
  readonly perceived: PerceivedActors | undefined;
  readonly onFollow: (id: string) => void;
  readonly onHide: (id: string) => void;
}) {
  const step = Math.min(useStep(clock), recording.loaded - 1);
  const base = step * recording.actors.length;
  const present = (row: number) => !Number.isNaN(recording.x[base + row] ?? Number.NaN);
  const distance = (row: number) =>
    Math.hypot(
      (recording.x[base + row] ?? Number.NaN) - (recording.x[base + ego] ?? Number.NaN),
      (recording.y[base + row] ?? Number.NaN) - (recording.y[base + ego] ?? Number.NaN),
    );
  const speed: Column<Actor> = {
    id: "speed",
    title: "m/s",
    hint: "Speed",
    width: "66px",
    numeric: true,
    cell: ({ row }) => (present(row) ? fixed(recording.speed[base + row], 1) : "absent"),
  };
  const columns: readonly Column<Actor>[] = [
    {
      id: "actor",
      title: "Actor",
      width: "minmax(84px, 1fr)",
      cell: (actor) => (
        <span
          className="actor"
          data-role={actor.role}
          data-gone={!present(actor.row)}
          data-followed={actor.id === followed}
          title={`${actor.id}: ${ROLES[actor.role]}, ${actor.model}, ${fixed(actor.length, 2)} × ${fixed(actor.width, 2)} m`}
        >
          <i style={{ color: colourToken(actor) }} />
          {actor.id}
          {actor.id === followed && <b title="followed">◎</b>}
        </span>
      ),
    },
    {
      id: "distance",
      title: "away (m)",
      hint: "From the ego, centre to centre",
      width: "84px",
      numeric: true,
      cell: ({ row }) => (row === ego || !present(row) ? "" : fixed(distance(row), 1)),
    },
    ...(perceived
      ? [
          {
            id: "sight",
            title: "Perceived",
            hint: "Whether the ego perceived it, and why not",
            width: "104px",
            cell: ({ row }: Actor) => perceived.words(step, row),
          },
        ]
      : [speed]),
    {
      id: "hide",
      title: "",
      width: "62px",
      cell: ({ id }) => (
        <button
          type="button"
          className="plain"
          aria-pressed={hidden.includes(id)}
          onClick={() => onHide(id)}
        >
          {hidden.includes(id) ? "show" : "hide"}
        </button>
      ),
    },
  ];
  return (
    <DataTable
      label="Actors"
      columns={columns}
      rows={recording.actors}
      idOf={(actor) => actor.id}
      onOpen={(actor) => onFollow(actor.id === followed ? "" : actor.id)}
      height="100%"
    />
  );
}
