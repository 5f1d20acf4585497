// The text of the file, with faults beside their lines. What is typed is read at once, and written when it is saved.
import {useEffect, useRef, useState} from 'preact/hooks';
import {draft, draftFaults, faults, saveDraft, saving, shownText, typed, type Fault} from './capture';
import {inFile, wantedLine} from './chosen';

const lineHeight = 18;

function byLine(): Map<number, Fault[]> {
  const out = new Map<number, Fault[]>();
  const all = draft.value === null ? faults.value : draftFaults.value;
  for (const one of all) if (inFile(one)) out.set(one.line, [...(out.get(one.line) ?? []), one]);
  return out;
}

export function TextPane() {
  const area = useRef<HTMLTextAreaElement>(null);
  const [scrolled, setScrolled] = useState({top: 0, left: 0});
  const text = shownText();
  const lines = text.split('\n');
  const found = byLine();
  useEffect(() => {
    const line = wantedLine.value, box = area.current;
    if (!line || !box) return;
    const from = lines.slice(0, line - 1).reduce((sum, one) => sum + one.length + 1, 0);
    box.focus();
    box.setSelectionRange(from, from + (lines[line - 1]?.length ?? 0));
    box.scrollTop = Math.max(0, (line - 4) * lineHeight);
    box.scrollLeft = 0;
    wantedLine.value = 0;
  }, [wantedLine.value]);
  const keys = (event: KeyboardEvent): void => {
    if ((event.ctrlKey || event.metaKey) && event.key === 's') {
      event.preventDefault();
      void saveDraft();
    }
  };
  const first = Math.max(0, Math.floor(scrolled.top / lineHeight) - 1);
  const visible = [...lines.keys()].slice(first, first + 120);
  return (
    <div class="text-pane">
      <div class="toolbar">
        <button class="primary" disabled={draft.value === null || saving.value} onClick={() => void saveDraft()}>Save</button>
        <button disabled={draft.value === null} onClick={() => (draft.value = null)}>Discard</button>
        <span role="status" class="note">{draft.value === null ? 'as in the file' : `not saved yet (Ctrl-S); ${draftFaults.value.length || 'no'} fault${draftFaults.value.length === 1 ? '' : 's'} of reading`}</span>
      </div>
      <div class="text-lines">
        <div class="gutter" aria-hidden="true">
          <div style={{transform: `translateY(${first * lineHeight - scrolled.top}px)`}}>
            {visible.map((i) => <div key={i} class={found.has(i + 1) ? (found.get(i + 1)!.some((one) => one.stops) ? 'stops' : 'warns') : ''}>{i + 1}</div>)}
          </div>
        </div>
        <div class="text-box">
          <textarea ref={area} aria-label="Text of the capture" wrap="off" spellcheck={false} value={text} onKeyDown={keys}
                    onInput={(e) => typed(e.currentTarget.value)}
                    onScroll={(e) => setScrolled({top: e.currentTarget.scrollTop, left: e.currentTarget.scrollLeft})} />
          <div class="in-line" aria-hidden="true">
            {visible.filter((i) => found.has(i + 1)).map((i) => (
              <span key={i} class={found.get(i + 1)!.some((one) => one.stops) ? 'stops' : 'warns'} style={{top: `${i * lineHeight - scrolled.top + 6}px`,
                left: `calc(${lines[i].length + 2}ch + 6px - ${scrolled.left}px)`}}>{found.get(i + 1)!.map((one) => one.wrong).join('; ')}</span>))}
          </div>
        </div>
      </div>
      <ul class="fault-lines" aria-label="Faults of the text">
        {[...found].sort(([a], [b]) => a - b).flatMap(([line, all]) => all.map((one, i) => (
          <li key={`${line} ${i}`} class={one.stops ? 'stops' : 'warns'}><button class="link" onClick={() => (wantedLine.value = line)}>line {line}</button> {one.wrong}{one.right && <em>. {one.right}</em>}</li>)))}
      </ul>
    </div>
  );
}
