// Light or dark: as the system has it, until the user says otherwise.
import { byId } from './dom.js';

export function wireTheme(store) {
  const system = matchMedia('(prefers-color-scheme: dark)');
  let isChosen = false;
  const follow = () => { if (!isChosen) store.set({ theme: system.matches ? 'dark' : 'light' }); };
  system.addEventListener('change', follow);
  store.on(['theme'], ({ theme }) => { document.documentElement.dataset.theme = theme; });
  follow();
  byId('theme').addEventListener('click', () => {
    isChosen = true;
    store.set({ theme: store.get().theme === 'dark' ? 'light' : 'dark' });
  });
}
