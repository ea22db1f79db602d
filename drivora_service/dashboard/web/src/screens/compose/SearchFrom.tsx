import { Link } from "@tanstack/react-router";
import type { Search } from "../../address";
import { useScope } from "../../shell/session";

/** Leads to the form for a campaign that searches from a scenario; nothing for who may not. */
export function SearchFrom({ search }: { readonly search: Search }) {
  const { maySubmit } = useScope();
  if (!maySubmit) return null;
  return (
    <Link
      to="/campaigns/new"
      search={search}
      className="button"
      title="Compose a campaign that varies this scenario"
    >
      Search from here
    </Link>
  );
}

/** Leads to the form for the same campaign or study, to change something and start it again. */
export function AgainWith({
  kind,
  id,
}: {
  readonly kind: "campaign" | "study";
  readonly id: string;
}) {
  const { maySubmit } = useScope();
  if (!maySubmit) return null;
  return (
    <Link
      to={kind === "campaign" ? "/campaigns/new" : "/studies/new"}
      search={{ [kind]: id }}
      className="button"
      title={`Compose a ${kind} that begins with the settings of this one`}
    >
      Again with other settings
    </Link>
  );
}
