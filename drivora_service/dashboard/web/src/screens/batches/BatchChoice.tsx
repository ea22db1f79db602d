import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { api, body } from "../../api/client";
import { Menu } from "../../components/Menu";
import { count, moment } from "../../components/numbers";
import { type Batch, olderFirst } from "./batch";

const OFFERED = 100;

/** Chooses a batch to compare with: those with as many runs come first. */
export function BatchChoice({ batch }: { readonly batch: Batch }) {
  return (
    <Menu label="Compare with…" align="right">
      {() => <Offered batch={batch} />}
    </Menu>
  );
}

function Offered({ batch }: { readonly batch: Batch }) {
  const { data, error } = useQuery({
    queryKey: ["batch", "list", "to compare"],
    queryFn: async () =>
      body(
        await api.GET("/api/v1/batches", {
          params: { query: { limit: OFFERED, priority: ["interactive", "ci"] } },
        }),
      ),
  });
  if (error) return <p role="alert">{error.message}</p>;
  if (!data) return <p className="quiet note">Loading</p>;
  const away = ({ size }: Batch) => Math.abs(size - batch.size);
  const others = data.items
    .filter(({ id }) => id !== batch.id)
    .toSorted((a, b) => away(a) - away(b));
  if (others.length === 0) return <p className="quiet note">There is no other batch.</p>;
  return (
    <ul className="menu-list" aria-label="Batches to compare with">
      {others.map((other) => {
        const [a, b] = [batch, other].toSorted(olderFirst);
        return (
          <li key={other.id}>
            <Link
              to="/compare/batches"
              search={{ a: a?.id, b: b?.id }}
              className="batch-choice"
              title={other.id}
            >
              <span>{other.name || other.id}</span>
              <span className="quiet">
                {count(other.size)} runs · {moment(other.created_at)}
              </span>
            </Link>
          </li>
        );
      })}
    </ul>
  );
}
