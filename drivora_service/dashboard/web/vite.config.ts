import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { brotliCompressSync, constants, gzipSync } from "node:zlib";
import react from "@vitejs/plugin-react";
import { defineConfig, type Plugin } from "vite";

const SERVICE = "http://127.0.0.1:8000";

/** Stores each text file compressed as well: the service sends what the browser accepts. */
function compressed(): Plugin {
  let built = "";
  return {
    name: "compressed",
    apply: "build",
    configResolved(config) {
      built = config.build.outDir;
    },
    closeBundle() {
      for (const folder of [built, join(built, "assets")]) {
        for (const name of readdirSync(folder)) {
          if (!/\.(html|js|css|svg)$/.test(name)) continue;
          const path = join(folder, name);
          const content = readFileSync(path);
          writeFileSync(`${path}.gz`, gzipSync(content, { level: 9 }));
          const size = { [constants.BROTLI_PARAM_SIZE_HINT]: content.length };
          writeFileSync(`${path}.br`, brotliCompressSync(content, { params: size }));
        }
      }
    },
  };
}

export default defineConfig({
  plugins: [react(), compressed()],
  experimental: {
    // The service may be under a path: only the document, which it completes, has whole addresses.
    renderBuiltUrl: (_, { hostType }) => (hostType === "html" ? undefined : { relative: true }),
  },
  build: { target: "es2023", assetsInlineLimit: 0, modulePreload: { polyfill: false } },
  worker: { format: "es" },
  server: { proxy: { "/api": SERVICE } },
});
