/** Chromium of a package, with the libraries of the package, so that the system needs none. */

import { mkdirSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import chromiumPackage, { inflate } from "@sparticuz/chromium";
import { type Browser, chromium } from "playwright-core";

const PACKAGE = dirname(dirname(createRequire(import.meta.url).resolve("@sparticuz/chromium")));
/** Beside the packages, which are removed before another version is installed. */
const UNPACKED = join(PACKAGE, "..", "..", ".chromium");
const FONTS = `<?xml version="1.0"?>
<!DOCTYPE fontconfig SYSTEM "fonts.dtd">
<fontconfig>
  <dir>/usr/share/fonts</dir>
  <dir>${UNPACKED}/fonts</dir>
  <cachedir>${UNPACKED}/fonts-cache</cachedir>
</fontconfig>
`;

/** Unpacks the browser unless it is there, and returns its program. */
export async function unpackBrowser(): Promise<string> {
  mkdirSync(UNPACKED, { recursive: true });
  const before = process.env.TMPDIR;
  process.env.TMPDIR = UNPACKED; // Where the package unpacks to.
  try {
    await inflate(join(PACKAGE, "bin", "al2023.tar.br"));
    writeFileSync(join(UNPACKED, "fonts.conf"), FONTS);
    return await chromiumPackage.executablePath();
  } finally {
    if (before === undefined) delete process.env.TMPDIR;
    else process.env.TMPDIR = before;
  }
}

export async function startBrowser(): Promise<Browser> {
  return chromium.launch({
    executablePath: await unpackBrowser(),
    env: {
      ...process.env,
      LD_LIBRARY_PATH: join(UNPACKED, "al2023", "lib"),
      FONTCONFIG_FILE: join(UNPACKED, "fonts.conf"),
    },
    args: [
      "--no-sandbox", // The tests may run as root.
      "--no-zygote",
      "--use-gl=angle", // WebGL without a graphics card.
      "--use-angle=swiftshader",
      "--enable-unsafe-swiftshader",
      "--font-render-hinting=none",
    ],
  });
}
