/** What the name of a file tells about the network in it. */

import type { paths } from "../../api/schema";

export type Format = paths["/api/v1/networks"]["post"]["parameters"]["query"]["format"];

export const FORMATS: Readonly<
  Record<Format, { readonly title: string; readonly endings: readonly string[] }>
> = {
  sumo: { title: "SUMO", endings: [".net.xml"] },
  opendrive: { title: "OpenDRIVE", endings: [".xodr"] },
  openstreetmap: { title: "OpenStreetMap", endings: [".osm", ".osm.xml"] },
};

const LONGEST_NAME = 64;

export function isNetworkName(name: string): boolean {
  return /^[A-Za-z0-9_-]{1,64}$/.test(name);
}

/** Returns the format of a file by its ending. */
export function formatOf(fileName: string): Format | undefined {
  const formats = Object.keys(FORMATS) as Format[];
  return formats.find((format) => endingOf(fileName, format) !== "");
}

/** Returns a name for the network in a file: that of the file, as far as it is allowed. */
export function proposedName(fileName: string): string {
  const format = formatOf(fileName);
  const ending = format ? endingOf(fileName, format) : /\.[^.]*$/.exec(fileName)?.[0];
  return fileName
    .slice(0, fileName.length - (ending?.length ?? 0))
    .normalize("NFD")
    .replace(/\p{Mark}/gu, "")
    .replace(/[^A-Za-z0-9_-]+/g, "-")
    .replace(/^-+|-+$/g, "")
    .slice(0, LONGEST_NAME);
}

function endingOf(fileName: string, format: Format): string {
  const endings = FORMATS[format].endings.filter((one) => fileName.toLowerCase().endsWith(one));
  return endings.toSorted((a, b) => b.length - a.length)[0] ?? "";
}
