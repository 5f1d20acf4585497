export function figure(value: number | null | undefined, digits = 3): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-3) return value.toExponential(digits - 1).replace('-', '−').replace('e−', 'e-');
  return Number(value.toPrecision(digits)).toString().replace('-', '−');
}
/** A logarithm of odds: a tenth matters however large it is. */
export function logEvidence(value: number | null | undefined): string {
  return value !== null && value !== undefined && Math.abs(value) >= 10 ? value.toFixed(1).replace('-', '−') : figure(value);
}
export function percent(share: number | undefined): string {
  return share === undefined || !Number.isFinite(share) ? '–' : `${Math.round(100 * share)} %`;
}
export function spaced(name: string): string {
  return name.replaceAll('_', ' ');
}
export function duration(seconds: number): string {
  if (seconds < 90) return `${Math.round(seconds)} s`;
  return `${Math.floor(seconds / 60)} min ${Math.round(seconds % 60)} s`;
}
/** A value and its interval, with as many digits as the interval's width is worth. */
export function around(value: number, low?: number, high?: number): {value: string; interval: string} {
  if (low === undefined || high === undefined || !(high > low)) return {value: figure(value, 4), interval: '–'};
  const largest = Math.max(Math.abs(value), Math.abs(low), Math.abs(high));
  const digits = Math.ceil(Math.log10(largest / (high - low))) + 2;
  const few = Math.min(8, Math.max(4, digits));
  return {value: figure(value, few), interval: `${figure(low, few)} .. ${figure(high, few)}`};
}
/** A path as one word of a command. */
export function forShell(path: string): string {
  return /^[\w@%+=:,./-]+$/.test(path) ? path : `'${path.replaceAll("'", "'\\''")}'`;
}
/** "a, b and c". */
export function listed(words: string[]): string {
  return words.length < 2 ? words.join('') : `${words.slice(0, -1).join(', ')} and ${words[words.length - 1]}`;
}
export function keysOf<K extends string>(names: Record<K, string>): readonly K[] {
  return Object.keys(names) as K[];
}
