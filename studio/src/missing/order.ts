// Which effects cannot be told apart: single linkage of the cosines between their signatures.
import type {EffectScore} from '../document';

/** Cosines are told from here on (estimation/diagnosis/diagnosis.cpp). */
export const leastCosine = 0.9;

/** Cosine of two effects, either may have told of it; undefined: below what is told. */
export function cosine(a: EffectScore, b: EffectScore): number | undefined {
  if (a === b) return 1;
  const told = (x: EffectScore, y: EffectScore): number =>
    x.confusion?.find((c) => c.effect === y.effect)?.cosine ?? 0;
  return Math.max(told(a, b), told(b, a)) || undefined;
}

/** Reordered so that those that are easily confused sit together; the strongest group first. */
export function together(effects: EffectScore[]): EffectScore[] {
  let groups = effects.map((e) => [e]);
  while (groups.length > 1) {
    let best = 0;
    let pair: [number, number] = [0, 0];
    for (let i = 0; i < groups.length; ++i)
      for (let j = i + 1; j < groups.length; ++j) {
        const near = Math.max(...groups[i].flatMap((a) => groups[j].map((b) => cosine(a, b) ?? 0)));
        if (near > best) [best, pair] = [near, [i, j]];
      }
    if (best <= 0) break;
    const [i, j] = pair;
    groups[i] = groups[i].concat(groups[j]);
    groups = groups.filter((_, k) => k !== j);
  }
  const top = (g: EffectScore[]): number => Math.max(...g.map((e) => e.evidence ?? -Infinity));
  return groups.sort((a, b) => top(b) - top(a)).flat();
}
