import { useQuery } from "@tanstack/react-query";
import { useNavigate, useSearch } from "@tanstack/react-router";
import { useEffect, useRef } from "react";
import { api, body } from "../../api/client";
import { documentSchemas } from "../../components/fields/documentSchemas";
import { Loading, Refused } from "../../components/States";
import { useGeometry } from "../../roads/useGeometry";
import { useTitle } from "../../shell/useTitle";
import { Begin } from "./Begin";
import { Desk } from "./Desk";
import { townOf } from "./scenario";
import { sourceOf, useSource } from "./sources";
import { useDraft } from "./useDraft";
import "../../components/fields/fields.css";
import "./author.css";

/** Where a scenario is written: on the map, in fields and as text. */
export function Author() {
  const search = useSearch({ from: "/author" });
  const navigate = useNavigate();
  const draft = useDraft();
  const town = townOf(draft.scenario);
  useTitle(town ? `Scenario on ${town}` : "Author");
  const source = sourceOf(search);
  const asked = useSource(source);
  const opened = useRef("");
  const { open } = draft;
  useEffect(() => {
    const key = JSON.stringify(source);
    if (!asked.data || !source || opened.current === key) return;
    opened.current = key;
    const { document, label, run = "" } = asked.data;
    open(document, { label, run });
    // What is written from here on is the draft; a reload does not begin again.
    void navigate({ to: ".", search: {}, replace: true });
  }, [asked.data, source, open, navigate]);
  const schemas = useQuery(documentSchemas);
  const networks = useQuery({
    queryKey: ["network", "names"],
    queryFn: async () => body(await api.GET("/api/v1/networks")).items.map(({ name }) => name),
  });
  const known = networks.data?.includes(town) === true;
  const geometry = useGeometry(known ? town : "");
  const error = asked.error ?? schemas.error ?? networks.error ?? geometry.error;
  if (error) return <Refused error={error} />;
  if (source || !schemas.data || !networks.data) return <Loading rows={14} />;
  if (!known) return <Begin draft={draft} networks={networks.data} town={town} />;
  if (!geometry.data) return <Loading rows={14} />;
  return (
    <Desk
      key={`${town} ${draft.opened}`}
      draft={draft}
      geometry={geometry.data}
      definitions={schemas.data}
      networks={networks.data}
    />
  );
}
