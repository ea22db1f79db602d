import { useQuery } from "@tanstack/react-query";
import { useNavigate } from "@tanstack/react-router";
import { useState } from "react";
import { api, body } from "../../api/client";
import { Mark } from "../../components/Mark";
import { moment } from "../../components/numbers";
import { useKeys } from "../../shell/keys";
import { useScope } from "../../shell/session";
import { changeWords, type Group, type GroupStatus, lookOfGroup, STATUS, STATUSES } from "./triage";
import { useDecisions, usePerson } from "./useDecisions";
import { groupText } from "./words";
import "./triage.css";

/** What the reader has written and not saved, and the revision of the group that was seen then. */
interface Written {
  readonly label?: string;
  readonly assignee?: string;
  readonly note?: string;
  readonly revision?: number;
}

/** What was decided about a group, and the form to decide: `1` to `4` set its status. */
export function GroupDecision({ group }: { readonly group: Group }) {
  const { maySubmit } = useScope();
  const { decide, split } = useDecisions();
  const navigate = useNavigate();
  const [by, setBy] = usePerson();
  // What is being written stays when somebody else, or a key, changes the group meanwhile.
  const [written, setWritten] = useState<Written>({});
  const { label, assignee, note } = { ...group, ...written };
  const write = (part: Written) =>
    setWritten((now) => ({ revision: group.revision, ...now, ...part }));
  const { id, revision } = group;
  const changed = label !== group.label || assignee !== group.assignee || note !== group.note;
  const save = () =>
    decide.mutate(
      { id, revision, ...written },
      {
        onSuccess: () => setWritten({}),
        // The reader has been told: what is there now is seen.
        onError: () => setWritten(({ revision: _, ...now }) => now),
      },
    );
  const setStatus = (status: GroupStatus) =>
    decide.mutate(
      { id, revision, status },
      {
        onSuccess: (now) =>
          setWritten((was) =>
            was.revision === revision ? { ...was, revision: now.revision } : was,
          ),
      },
    );
  useKeys(
    maySubmit
      ? STATUSES.map((status, place) => ({
          keys: String(place + 1),
          does: `status: ${STATUS[status].text}`,
          run: () => setStatus(status),
        }))
      : [],
  );
  const refusal = decide.error ?? split.error;
  return (
    <section className="panel triage" aria-label="Decision">
      {refusal && (
        <p role="alert" className="refusal">
          {refusal.message}
        </p>
      )}
      <div className="status-line">
        {maySubmit ? (
          <fieldset className="statuses">
            <legend className="hidden-visually">Status</legend>
            {STATUSES.map((status, place) => (
              <button
                key={status}
                type="button"
                aria-pressed={group.status === status}
                title={`${STATUS[status].text} (${place + 1})`}
                disabled={decide.isPending}
                onClick={() => setStatus(status)}
              >
                <Mark {...STATUS[status]} />
              </button>
            ))}
          </fieldset>
        ) : (
          <Mark {...lookOfGroup(group)} />
        )}
        {group.is_back && maySubmit && <Mark {...lookOfGroup(group)} />}
        {group.changed_at && (
          <span className="quiet">
            {group.changed_by || "someone"}, {moment(group.changed_at)}
          </span>
        )}
      </div>
      {maySubmit ? (
        <form
          onSubmit={(event) => {
            event.preventDefault();
            save();
          }}
          onKeyDown={(event) => {
            if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) save();
          }}
        >
          <label>
            Label
            <input
              value={label}
              maxLength={200}
              placeholder={group.names.map(groupText).join("; ")}
              onChange={(event) => write({ label: event.target.value })}
            />
          </label>
          <label>
            Assignee
            <input
              value={assignee}
              maxLength={100}
              placeholder="nobody"
              onChange={(event) => write({ assignee: event.target.value })}
            />
          </label>
          <label>
            Your name
            <input
              value={by}
              maxLength={100}
              placeholder="noted with what you decide"
              onChange={(event) => setBy(event.target.value || null)}
            />
          </label>
          <label className="wide">
            Note
            <textarea
              value={note}
              maxLength={10_000}
              rows={1}
              onChange={(event) => write({ note: event.target.value })}
            />
          </label>
          <button type="submit" className="primary" disabled={!changed || decide.isPending}>
            Save
          </button>
        </form>
      ) : (
        group.note && <p>{group.note}</p>
      )}
      {group.names.length > 1 && (
        <ul className="names">
          {group.names.map((name) => (
            <li key={name}>
              {groupText(name)}
              {maySubmit && (
                <button
                  type="button"
                  disabled={split.isPending}
                  onClick={() =>
                    split.mutate(
                      { id, names: [name], failures: [], label: "" },
                      {
                        onSuccess: (made) => void navigate({ to: ".", search: { group: made.id } }),
                      },
                    )
                  }
                >
                  Split off
                </button>
              )}
            </li>
          ))}
        </ul>
      )}
      {group.changed_at && <GroupHistory id={id} revision={revision} />}
    </section>
  );
}

/** Who decided what, and when. */
function GroupHistory({ id, revision }: { readonly id: string; readonly revision: number }) {
  const { data } = useQuery({
    queryKey: ["group", id, "changes", revision],
    queryFn: async () =>
      body(
        await api.GET("/api/v1/failures/groups/{group_id}/changes", {
          params: { path: { group_id: id } },
        }),
      ).items,
  });
  if (!data || data.length === 0) return null;
  return (
    <details className="history">
      <summary>
        {data.length} {data.length === 1 ? "change" : "changes"}
      </summary>
      <ol>
        {data.map((change, place) => (
          // biome-ignore lint/suspicious/noArrayIndexKey: the list only grows at its begin
          <li key={data.length - place}>
            <span className="quiet">{moment(change.at)}</span> {change.by || "someone"}:{" "}
            {changeWords(change)}
          </li>
        ))}
      </ol>
    </details>
  );
}
