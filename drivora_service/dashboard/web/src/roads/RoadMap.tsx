import { type ReactNode, useEffect, useRef, useState } from "react";
import type { Schemas } from "../api/client";
import { useTheme } from "../shell/theme";
import "./map.css";
import { type Camera, scaleBar } from "./camera";
import { MapStage } from "./MapStage";
import { type Palette, paletteNow } from "./palette";
import { RoadLayer } from "./roadLayer";
import { SignalLayer } from "./signalLayer";

/** A map with the roads and signals of a network. */
export interface DrawnMap {
  readonly stage: MapStage;
  readonly signals: SignalLayer;
  readonly palette: Palette;
}

export interface RoadMapProps {
  readonly geometry: Schemas["NetworkGeometry"];
  readonly label: string;
  /** Called with each new map, also after a change of theme; returns what undoes it. */
  readonly onMap: (map: DrawnMap) => (() => void) | undefined;
  readonly camera?: Camera | undefined;
  readonly onCamera?: (camera: Camera, byHand: boolean) => void;
  readonly children?: ReactNode;
}

/** A road network on a canvas: the wheel comes nearer, dragging moves it. */
export function RoadMap({ geometry, label, onMap, camera, onCamera, children }: RoadMapProps) {
  const frame = useRef<HTMLElement>(null);
  const theme = useTheme();
  const latest = useRef({ onMap, onCamera, camera });
  latest.current = { ...latest.current, onMap, onCamera };
  const [scale, setScale] = useState(1);
  const [failure, setFailure] = useState("");

  // biome-ignore lint/correctness/useExhaustiveDependencies: colours are read anew with each theme
  useEffect(() => {
    const element = frame.current;
    if (!element) return;
    let gone = false;
    let stage: MapStage | undefined;
    let undo: (() => void) | undefined;
    const palette = paletteNow();
    MapStage.make(element, palette).then(
      (made) => {
        if (gone) return made.destroy();
        stage = made;
        const roads = new RoadLayer(geometry, palette);
        const signals = new SignalLayer(geometry, palette);
        made.world.addChild(roads, signals);
        made.onCamera = (now, byHand) => {
          roads.show(now.scale);
          latest.current.camera = now;
          setScale(now.scale);
          latest.current.onCamera?.(now, byHand);
        };
        undo = latest.current.onMap({ stage: made, signals, palette });
        if (latest.current.camera) made.look(latest.current.camera);
        else made.fit(geometry.bounds as [number, number, number, number], false);
      },
      (error: unknown) => setFailure(error instanceof Error ? error.message : String(error)),
    );
    return () => {
      gone = true;
      undo?.();
      stage?.destroy();
    };
  }, [geometry, theme]);

  const metres = scaleBar(scale);
  return (
    <section ref={frame} className="map" aria-label={label}>
      {failure && (
        <p className="over top-left">
          The map cannot be drawn: {failure} The browser needs WebGL 2 for it.
        </p>
      )}
      <div className="over bottom-left scale-bar" style={{ width: metres * scale + 16 }}>
        {metres} m
      </div>
      {children}
    </section>
  );
}
