import { Link } from "@tanstack/react-router";
import { useRef } from "react";
import type { Search } from "../../address";
import type { Schemas } from "../../api/client";
import { count, moment } from "../../components/numbers";
import { Picture } from "../../components/Picture";
import { useKeys } from "../../shell/keys";
import { whyNone } from "./FailureCard";
import { groupText } from "./words";

type Group = Schemas["FailureGroup"];

/** Groups as cards: picture, sentence, count, first and last seen. `j` and `k` go through them. */
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
  const links = () => [...(list.current?.querySelectorAll<HTMLElement>("a.whole") ?? [])];
  const move = (by: number) => {
    const all = links();
    const now = all.indexOf(document.activeElement as HTMLAnchorElement);
    const next = all[Math.min(Math.max(now + by, 0), all.length - 1)];
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
        if (first) onOpen(first.group);
      },
    },
  ]);
  return (
    <ul
      ref={list}
      className="group-cards"
      onPointerEnter={() => onHold(true)}
      onPointerLeave={() => onHold(false)}
    >
      {groups.map((group) => (
        <li key={group.group} className="panel">
          <Picture
            src={group.example.picture_url}
            alt={`Moments of: ${group.sentence}`}
            none={whyNone(group.example)}
          />
          <div className="inside">
            <h2>
              <Link className="whole" to="." search={{ ...search, group: group.group }}>
                {groupText(group.group)}
              </Link>
            </h2>
            <p>{group.sentence}</p>
            <p className="facts">
              <strong className={group.avoidable > 0 ? "bad" : undefined}>
                {group.avoidable > 0
                  ? `${count(group.avoidable)} of ${count(group.failures)} count`
                  : `${count(group.failures)}, none counts`}
              </strong>
              <span>
                {group.campaigns > 0 &&
                  `${count(group.campaigns)} ${group.campaigns === 1 ? "campaign" : "campaigns"}, `}
                {count(group.towns)} {group.towns === 1 ? "network" : "networks"}
              </span>
            </p>
            <p className="quiet">
              first {moment(group.first_seen)}, last {moment(group.last_seen)}
            </p>
          </div>
        </li>
      ))}
    </ul>
  );
}
