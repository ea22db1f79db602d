import { defineConfig } from "vitest/config";

export default defineConfig({
  test: {
    projects: [
      { extends: "./vite.config.ts", test: { name: "unit", include: ["src/**/*.test.{ts,tsx}"] } },
      {
        extends: "./vite.config.ts",
        test: {
          name: "browser",
          include: ["browser/**/*.test.ts"],
          globalSetup: "browser/support/setup.ts",
          // One service and one browser for all: the files are tried one after the other.
          fileParallelism: false,
          testTimeout: 60_000,
          hookTimeout: 180_000,
        },
      },
    ],
  },
});
