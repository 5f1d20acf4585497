// The photos to choose from.
import {useEffect, useRef} from 'preact/hooks';
import {figure} from '../format';
import {chosenPhoto, figuresOf, floor, other, run, step} from '../state';

/** Every example and camera, with chi and what is left in it. */
export function PhotoList() {
  const list = run.value.photos;
  const box = useRef<HTMLUListElement>(null);
  // The keys n and p change the photo from anywhere; only the list scrolls, not a phone's page.
  useEffect(() => {
    const [ul, li] = [box.current, document.getElementById(`photo-${chosenPhoto.value}`)];
    if (!ul || !li) return;
    ul.scrollTop = Math.max(li.offsetTop + li.offsetHeight - ul.clientHeight, Math.min(ul.scrollTop, li.offsetTop));
  }, [chosenPhoto.value]);
  return (
    <ul ref={box} class="photos" role="listbox" aria-label="Photos" tabIndex={0}
        aria-activedescendant={`photo-${chosenPhoto.value}`}
        onKeyDown={(event) => {
          const by = {ArrowDown: 1, ArrowUp: -1, ArrowRight: 1, ArrowLeft: -1}[event.key];
          if (!by) return;
          event.preventDefault();
          chosenPhoto.value = (chosenPhoto.value + by + list.length) % list.length;
        }}>
      {list.map((photo, i) => {
        const told = figuresOf(step.value, photo);
        const then = figuresOf(other.value, photo);
        const over = told ? told.chi / floor.value.chi : 0;
        return (
          <li key={photo.name} id={`photo-${i}`} role="option" aria-selected={i === chosenPhoto.value}
              onClick={() => (chosenPhoto.value = i)}>
            <span class="name">{photo.example}<small> {photo.camera}{photo.use === 'validate' ? ' · held out' : ''}</small></span>
            <span class="value">{figure(told?.chi)}{then && ` → ${figure(then.chi)}`}</span>
            <span class="bar" style={{width: `${Math.min(100, (100 * Math.log2(1 + over)) / 4)}%`}} />
          </li>
        );
      })}
    </ul>
  );
}
