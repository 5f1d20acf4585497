// The words that the page cannot do without, a sentence each; a "?" beside a word leads here.
import {useEffect} from 'preact/hooks';
import {signal} from '@preact/signals';
import {verb} from '../state';

const words = {
  chi: ['residual', 'normalised residual: model minus photo over noise, as a root mean square (χ in files). 1 is noise alone, 10 ten times the noise'],
  sigma: ['σ', 'standard deviation of the noise of a pixel, or of a measured force: the unit of residuals'],
  floor: ['noise floor', 'the normalised residual that the reference images (photos at rest) keep once motion that is smooth over a photo is taken out: noise, and what the renderer gets wrong'],
  evidence: ['log BF', 'log Bayes factor of the effect against no effect (evidence in files): 5 is odds of 150 to 1, a tenth more or less is 10 %'],
  gate: ['critical value', 'the log Bayes factor that chance alone exceeds in 5 % of simulated runs, over all effects (gate in files), at least 5. It knows of noise alone: an effect above it is still not named where what it would remove is less than a renderer, a lens or the mesh may err by'],
  explains: ['would remove', 'share of the excess misfit (what the photos have over the noise floor) that the effect would remove, to first order'],
  weight: ['weight', 'share of an effect when one of those listed must be the cause; refits decide between close ones'],
  dof: ['dof', 'how many numbers the effect could choose freely; more fit more of the noise, which its evidence pays for'],
  heldOut: ['held out', 'photos of use: validate. No value is fitted to them, but they help to choose among effects: one that is real helps there too. Photos of use: test have no part in any choice'],
  tried: ['screening', 'normalised residual over what half-size photos at rest kept of the model before, fitted / held-out photos, after two steps of a refit with the effect (floor: less than that): those that get farthest are refitted to the end'],
  refit: ['refit', 'the whole model fitted again with the effect in it; its score, not the estimate, decides'],
} satisfies Record<string, [string, string]>;
export type Word = keyof typeof words;

const wanted = signal<Word | ''>('');

/** Leads to what a word means. */
export function Ask(props: {word: Word}) {
  return (
    <button class="ask" aria-label={`What ${words[props.word][0]} means`} title={words[props.word][1]} onClick={(event) => {
      event.stopPropagation();
      wanted.value = props.word;
      verb.value = 'facts';
      document.getElementById('tab-facts')?.focus();
    }}>?</button>
  );
}

export function Glossary() {
  useEffect(() => {
    if (wanted.value) document.getElementById('word-' + wanted.value)?.scrollIntoView({block: 'center'});
    const read = wanted.value;
    return () => {
      if (wanted.value === read) wanted.value = '';
    };
  }, [wanted.value]);
  return (
    <dl class="glossary">
      {Object.entries(words).map(([id, [word, meaning]]) => (
        <div key={id} id={'word-' + id} class={id === wanted.value ? 'wanted' : ''}><dt>{word}</dt><dd>{meaning}</dd></div>
      ))}
    </dl>
  );
}
