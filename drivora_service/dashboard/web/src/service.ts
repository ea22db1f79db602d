/** The part of an address before the folder of the page's scripts. */
const BEFORE_SCRIPTS = /^(.*)\/assets\/[^/]+$/;

/**
 * Returns the path that the service is under, from the address of one of its scripts.
 *
 * The document names the scripts by their whole paths, and pages and their workers load others
 * relative to these. The development server has the sources instead, at the root of its host.
 */
export function rootOf(script: string): string {
  return new URL(script).pathname.match(BEFORE_SCRIPTS)?.[1] ?? "";
}

/** The path that the service is under, "" at the root of its host. */
export const ROOT = rootOf(import.meta.url);

/** Returns the address of something that the service has: `/docs` is `/drivora/docs`. */
export function addressOf(path: string): string {
  return `${ROOT}${path}`;
}

/** Returns the address of the service, as commands take it. */
export function serviceAddress(): string {
  return `${window.location.origin}${ROOT}`;
}
