import { Link } from "@tanstack/react-router";
import { useEffect, useRef } from "react";
import type { Schemas } from "../../api/client";
import { count, fixed } from "../../components/numbers";

/** The network that was imported, with the way to its map. */
export function Imported({ network }: { readonly network: Schemas["Network"] }) {
  const { name, drivable_km, traffic_lights } = network;
  const link = useRef<HTMLAnchorElement>(null);
  useEffect(() => link.current?.focus(), []);
  return (
    <div className="imported">
      <p role="status">
        Imported <strong>{name}</strong>: {fixed(drivable_km, 1)} km of lanes,{" "}
        {count(traffic_lights)} {traffic_lights === 1 ? "traffic light" : "traffic lights"}.
      </p>
      <Link ref={link} to="/networks/$name" params={{ name }} search={{}} className="button">
        Look at {name}
      </Link>
    </div>
  );
}
