/** Names of the lights of lights.js, apart from it because three.js is for the browser alone. */
export const LIGHT_NAMES = ['room', 'sky', 'sun'];
