import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { api, body } from "../../api/client";
import { Menu } from "../../components/Menu";
import { moment } from "../../components/numbers";
import { TimeChoice } from "../../components/TimeChoice";
import { isTime } from "./triage";

/** As many of each kind are known by their names. */
const KNOWN = 200;
const MOST_SHOWN = 9;

/** What failures are compared with: those before a time, or of a study, a campaign or a batch. */
export function BaselineMenu({
  baseline,
  onChoose,
}: {
  readonly baseline: string;
  readonly onChoose: (baseline: string) => void;
}) {
  return (
    <Menu
      align="right"
      active={baseline !== ""}
      title="Which failures are new, the same or gone since then"
      label={
        baseline ? (
          <>
            <span className="quiet">Baseline</span>{" "}
            {isTime(baseline) ? `before ${moment(baseline).slice(0, 16)}` : <Named id={baseline} />}
          </>
        ) : (
          "Baseline"
        )
      }
    >
      {(close) => {
        const choose = (value: string) => {
          onChoose(value);
          close();
        };
        return (
          <>
            <p className="quiet note">Failures found before</p>
            <TimeChoice value={isTime(baseline) ? baseline : ""} onChoose={choose} />
            <Owners onChoose={choose} />
          </>
        );
      }}
    </Menu>
  );
}

interface Owner {
  readonly id: string;
  readonly name: string;
  readonly kind: string;
}

/** The newest studies, campaigns and batches; those of campaigns are their campaign. */
function useOwners(): readonly Owner[] {
  const query = { limit: KNOWN };
  const { data } = useQuery({
    queryKey: ["baselines"],
    queryFn: async () => {
      const [studies, campaigns, batches] = await Promise.all([
        api.GET("/api/v1/studies", { params: { query } }),
        api.GET("/api/v1/campaigns", { params: { query } }),
        api.GET("/api/v1/batches", {
          params: { query: { ...query, priority: ["interactive", "ci"] } },
        }),
      ]);
      const owners = (kind: string, items: readonly { id: string; name: string }[]) =>
        items.map(({ id, name }) => ({ id, name: name || id, kind }));
      return [
        ...owners("study", body(studies).items),
        ...owners("campaign", body(campaigns).items),
        ...owners("batch", body(batches).items),
      ];
    },
  });
  return data ?? [];
}

function Named({ id }: { readonly id: string }) {
  const owner = useOwners().find((one) => one.id === id);
  return <>{owner ? owner.name : id}</>;
}

function Owners({ onChoose }: { readonly onChoose: (id: string) => void }) {
  const owners = useOwners();
  const [text, setText] = useState("");
  const wanted = text.trim().toLowerCase();
  const found = owners.filter(
    ({ id, name }) => name.toLowerCase().includes(wanted) || id.startsWith(wanted),
  );
  return (
    <>
      <form
        onSubmit={(event) => {
          event.preventDefault();
          // An id may be that of one too old to be listed.
          const id = found[0]?.id ?? text.trim();
          if (id) onChoose(id);
        }}
      >
        <input
          className="wide"
          aria-label="Name or id of a batch, a campaign or a study"
          placeholder="or those of: name or id"
          value={text}
          onChange={({ target }) => setText(target.value)}
        />
      </form>
      <ul className="menu-list">
        {found.slice(0, MOST_SHOWN).map(({ id, name, kind }) => (
          <li key={id}>
            <button type="button" className="item" title={id} onClick={() => onChoose(id)}>
              <span className="word">{name}</span> <span className="quiet">{kind}</span>
            </button>
          </li>
        ))}
      </ul>
      {found.length > MOST_SHOWN && (
        <p className="quiet note">{found.length - MOST_SHOWN} more: type a part of the name</p>
      )}
      {found.length === 0 && wanted !== "" && (
        <p className="quiet note">None has this name; enter takes an id</p>
      )}
    </>
  );
}
