// Light and dark. Debian's furo brings this script as a module, which a page that is opened as a file may not load: it stands in
// its place.
(function () {
  const system = window.matchMedia('(prefers-color-scheme: dark)');
  let chosen = null;
  try {
    chosen = localStorage.getItem('theme');
  } catch (refused) {
    // a browser may keep nothing for files
  }
  function show() {
    const dark = chosen === 'dark' || (chosen !== 'light' && system.matches);
    document.body.dataset.theme = dark ? 'dark' : 'light';
  }
  document.documentElement.classList.remove('no-js');
  for (const button of document.getElementsByClassName('theme-toggle')) {
    button.addEventListener('click', () => {
      chosen = document.body.dataset.theme === 'dark' ? 'light' : 'dark';
      try {
        localStorage.setItem('theme', chosen);
      } catch (refused) {
        // then it holds for this page alone
      }
      show();
    });
  }
  system.addEventListener('change', show);
  show();
})();
