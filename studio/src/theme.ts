// Dark or light: as the system has it, until somebody chooses.
import {theme} from './state';

const system = matchMedia('(prefers-color-scheme: dark)');
function setTheme(wanted: 'light' | 'dark'): void {
  document.documentElement.dataset.theme = wanted;
  theme.value = wanted;
}
export const turnTheme = (): void => setTheme(theme.value === 'dark' ? 'light' : 'dark');

export function followSystem(): void {
  setTheme(system.matches ? 'dark' : 'light');
  system.addEventListener('change', () => setTheme(system.matches ? 'dark' : 'light'));
}
