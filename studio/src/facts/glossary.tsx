// The words that the page cannot do without, one line each; a "?" beside a word leads here.
import {useEffect} from 'preact/hooks';
import {signal} from '@preact/signals';
import {verb} from '../state';

const words = {
  chi: ['χ', 'residual over noise, as a root mean square: 1 is noise alone, 10 is ten times the noise'],
  sigma: ['σ', 'standard deviation of the noise of a pixel, or of a measured force: the unit of residuals'],
  floor: ['floor', 'the χ that the rest photos keep once motion that is smooth over a photo is taken out: noise, and what the renderer gets wrong'],
  evidence: ['evidence', 'logarithm of the odds that the effect is there against that it is not: 5 is 150 to 1, a tenth more or less is 10 %'],
  gate: ['gate', 'evidence that chance alone reaches in less than 5 % of simulated runs, at least 5: nothing below it is named'],
  weight: ['weight', 'share of an effect when one of those listed must be the cause; refits decide between close ones'],
  dof: ['dof', 'how many numbers the effect could choose freely; more fit more of the noise, which its evidence pays for'],
  heldOut: ['held out', 'photos that no fit has seen: an effect that is real helps there too'],
  tried: ['tried χ', 'misfit of fitted / held-out photos over the floor, at half size, after two steps of a refit with the effect: those that get farthest are refitted to the end'],
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
