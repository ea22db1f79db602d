import { useQuery } from "@tanstack/react-query";
import { api, body } from "../../api/client";
import { Menu } from "../../components/Menu";
import { moment } from "../../components/numbers";
import { TimeChoice } from "../../components/TimeChoice";
import { isTime } from "./triage";

const MOST = 5;

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

/** The newest studies, campaigns and batches. */
function useOwners(): readonly Owner[] {
  const query = { limit: MOST };
  const { data } = useQuery({
    queryKey: ["baselines"],
    queryFn: async () => {
      const [studies, campaigns, batches] = await Promise.all([
        api.GET("/api/v1/studies", { params: { query } }),
        api.GET("/api/v1/campaigns", { params: { query } }),
        api.GET("/api/v1/batches", { params: { query } }),
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
  return (
    <>
      {owners.length > 0 && <p className="quiet note">Or those of one of the newest</p>}
      <ul className="menu-list">
        {owners.map(({ id, name, kind }) => (
          <li key={id}>
            <button type="button" className="item" onClick={() => onChoose(id)}>
              <span className="word">{name}</span> <span className="quiet">{kind}</span>
            </button>
          </li>
        ))}
      </ul>
      <form
        className="row"
        onSubmit={(event) => {
          event.preventDefault();
          onChoose(String(new FormData(event.currentTarget).get("id") ?? "").trim());
        }}
      >
        <input
          name="id"
          aria-label="Id of a study, a campaign or a batch"
          placeholder="id"
          size={26}
        />
        <button type="submit">Apply</button>
      </form>
    </>
  );
}
