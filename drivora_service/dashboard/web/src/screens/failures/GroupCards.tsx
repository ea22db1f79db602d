import { Link } from "@tanstack/react-router";
import { useRef, useState } from "react";
import type { Search } from "../../address";
import { Confirm } from "../../components/Confirm";
import { Mark } from "../../components/Mark";
import { count, moment } from "../../components/numbers";
import { Picture } from "../../components/Picture";
import { useKeys } from "../../shell/keys";
import { useScope } from "../../shell/session";
import { whyNone } from "./FailureCard";
import { countWords, type Group, lookOfGroup, SINCE, titleOf } from "./triage";
import { useDecisions } from "./useDecisions";

/**
 * Groups as cards: picture, sentence, count, status, first and last seen. `j` and `k` go through
 * them, `x` selects, `m` merges the selected.
 */
export function GroupCards({
  groups,
  search,
  onOpen,
  onHold,
}: {
  readonly groups: readonly Group[];
  readonly search: Search;
  readonly onOpen: (group: string) => void;
  readonly onHold: (held: boolean) => void;
}) {
  const list = useRef<HTMLUListElement>(null);
  const { maySubmit } = useScope();
  const { merge } = useDecisions();
  const [selected, setSelected] = useState<readonly string[]>([]);
  const [asking, setAsking] = useState(false);
  const chosen = selected.flatMap((id) => groups.find((one) => one.id === id) ?? []);
  const toggle = (id: string) =>
    setSelected((now) => (now.includes(id) ? now.filter((one) => one !== id) : [...now, id]));
  const links = () => [...(list.current?.querySelectorAll<HTMLElement>("a.whole") ?? [])];
  const current = () => links().indexOf(document.activeElement as HTMLAnchorElement);
  const move = (by: number) => {
    const all = links();
    const next = all[Math.min(Math.max(current() + by, 0), all.length - 1)];
    next?.focus();
    next?.closest("li")?.scrollIntoView({ block: "nearest" });
  };
  useKeys([
    { keys: "j", does: "next group", run: () => move(1) },
    { keys: "k", does: "previous group", run: () => move(-1) },
    {
      keys: "enter",
      does: "open the group",
      run: () => {
        const first = groups[0];
        if (first) onOpen(first.id);
      },
    },
    ...(maySubmit
      ? [
          {
            keys: "x",
            does: "select the group",
            run: () => {
              const group = groups[current()];
              if (group) toggle(group.id);
            },
          },
          {
            keys: "m",
            does: "merge the selected groups",
            run: () => chosen.length > 1 && setAsking(true),
          },
        ]
      : []),
  ]);
  const [into, ...others] = chosen;
  return (
    <>
      {merge.isError && (
        <p role="alert" className="refusal">
          {merge.error.message}
        </p>
      )}
      {into && (
        <p className="selected-groups">
          <button
            type="button"
            className="primary"
            disabled={others.length === 0 || merge.isPending}
            title={others.length > 0 ? "Merge (m)" : "Two groups or more can be merged"}
            onClick={() => setAsking(true)}
          >
            {others.length > 0 ? `Merge ${chosen.length} groups` : "1 selected: choose others"}
          </button>
          <button type="button" onClick={() => setSelected([])} aria-label="Select no group">
            ×
          </button>
        </p>
      )}
      {asking && into && (
        <Confirm
          title={`Merge ${chosen.length} groups?`}
          action="Merge them"
          onYes={() => {
            merge.mutate(
              { into: into.id, groups: others.map(({ id }) => id) },
              { onSuccess: () => setSelected([]) },
            );
          }}
          onClose={() => setAsking(false)}
        >
          All failures of {others.map(titleOf).join(" and of ")}, also those found later, will be in
          “{titleOf(into)}”, with its status and note. They can be split off again.
        </Confirm>
      )}
      <ul
        ref={list}
        className="group-cards"
        onPointerEnter={() => onHold(true)}
        onPointerLeave={() => onHold(false)}
      >
        {groups.map((group) => (
          <li key={group.id} className="panel" data-selected={selected.includes(group.id)}>
            <Picture
              src={group.example.picture_url}
              alt={`Moments of: ${group.sentence}`}
              none={whyNone(group.example)}
            />
            <div className="inside">
              <h2>
                <Link className="whole" to="." search={{ ...search, group: group.id }}>
                  {titleOf(group)}
                </Link>
                {maySubmit && (
                  <input
                    type="checkbox"
                    aria-label={`Select ${titleOf(group)}`}
                    title="Select (x)"
                    checked={selected.includes(group.id)}
                    onChange={() => toggle(group.id)}
                  />
                )}
              </h2>
              <p>{group.sentence}</p>
              <p className="facts">
                <strong className={group.avoidable > 0 ? "bad" : undefined}>
                  {countWords(group)}
                </strong>
                <span hidden={group.failures === 0}>
                  {group.campaigns > 0 &&
                    `${count(group.campaigns)} ${group.campaigns === 1 ? "campaign" : "campaigns"}, `}
                  {count(group.towns)} {group.towns === 1 ? "network" : "networks"}
                </span>
              </p>
              <p className="decided">
                {/* Beside a baseline "new" would be read as new since then. */}
                {(group.since_baseline === null || group.status !== "new" || group.is_back) && (
                  <Mark {...lookOfGroup(group)} />
                )}
                {group.since_baseline && <Mark {...SINCE[group.since_baseline]} />}
                {group.assignee && <span>{group.assignee}</span>}
                <span className="quiet">
                  {moment(group.first_seen).slice(0, 16)} to {moment(group.last_seen).slice(0, 16)}
                </span>
              </p>
              {group.note && <p className="note-line">{group.note}</p>}
            </div>
          </li>
        ))}
      </ul>
    </>
  );
}
